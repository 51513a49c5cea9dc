#include "report/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <utility>

#include "controlspace/error.h"
#include "io/text/output_file.h"
#include "report/html.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder)) {
        throw InputError(fmt::format("{}: cannot be made ({}): choose another output folder",
                                     folder.string(), error ? error.message() : "it is a file"));
    }
}

}  // namespace

Report::Report(fs::path folder)
    : folder_(std::move(folder)),
      drawn_(folder_ / fmt::format("report-pictures.{}.partial", ::getpid())) {
    make_folder(folder_);
    make_folder(drawn_);
}

Report::~Report() { abandon(); }

void Report::abandon() const {
    std::error_code ignored;
    fs::remove_all(drawn_, ignored);
}

void Report::add_heading(std::string_view title) {
    ++headings_;
    contents_ += fmt::format("<a href=\"#section-{}\">{}</a>\n", headings_, html_text(title));
    body_ += fmt::format("<h2 id=\"section-{}\">{}</h2>\n", headings_, html_text(title));
}

void Report::add_subheading(std::string_view title) {
    body_ += fmt::format("<h3>{}</h3>\n", html_text(title));
}

void Report::add_paragraph(std::string_view text) {
    body_ += fmt::format("<p>{}</p>\n", html_text(text));
}

void Report::add_figures(std::span<const Figure> figures) {
    body_ += "<div class=\"figures\">\n";
    for (const Figure& figure : figures) {
        gnuplot_.draw(figure, drawn_);
        body_ += html_figure(
            figure, file_bytes(drawn_ / (figure.name + (figure.raster ? ".png" : ".svg"))));
    }
    body_ += "</div>\n";
}

void Report::add_tables(std::span<const TextTable> tables) {
    for (const TextTable& table : tables) body_ += html_table(table);
}

void Report::commit(std::string_view title) {
    OutputFile file(page());
    file.write(html_page(title, "<nav>\n" + contents_ + "</nav>\n" + body_));
    const fs::path pictures = folder_ / "report-pictures";
    make_folder(pictures);
    for (const auto& picture : fs::directory_iterator(drawn_)) {
        std::error_code error;
        fs::rename(picture.path(), pictures / picture.path().filename(), error);
        if (error) {
            throw InputError(fmt::format("cannot write {}: {}",
                                         (pictures / picture.path().filename()).string(),
                                         error.message()));
        }
    }
    file.commit();
}

}  // namespace controlspace
