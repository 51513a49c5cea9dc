#include "report/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "controlspace/error.h"
#include "study/child_program.h"
#include "study/results.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

constexpr double time_limit_s = 120;
constexpr double png_scale = 1.5;  // enough for print at the width of a page

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// As much of a command line as stands under a picture: the page beside it has all.
std::string shortened(std::string_view text) {
    constexpr std::size_t most = 120;
    if (text.size() <= most) return std::string(text);
    std::size_t end = most;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
    return std::string(text.substr(0, end)) + "...";
}

/// gnuplot does not say when a disk is full: what it wrote must end as such a file does.
bool ends_with(const fs::path& file, std::string_view end) {
    const std::string bytes = file_bytes(file);
    constexpr std::size_t more = 8;  // a line's end, a checksum
    return bytes.find(end, bytes.size() - std::min(bytes.size(), end.size() + more)) != bytes.npos;
}

}  // namespace

std::string file_bytes(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return "";  // a device need not end
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string gnuplot_string(std::string_view text) {
    std::string quoted = "'";
    for (const char c : text) {
        quoted += is_control(c) ? ' ' : c;
        if (c == '\'') quoted += c;
    }
    return quoted + '\'';
}

std::string gnuplot_title(std::string_view title) {
    const auto colon = title.find(": ");
    if (colon == title.npos) return gnuplot_string(title);
    return gnuplot_string(title.substr(0, colon + 1)) + ".\"\\n\"." +
           gnuplot_string(title.substr(colon + 2));
}

std::string gnuplot_cell(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) quoted += is_control(c) ? ' ' : c == '"' || c == '\\' ? '\'' : c;
    return quoted + '"';
}

std::string gnuplot_script(const Figure& figure) {
    std::string script = "# gnuplot " + figure.name + ".gp\nset encoding utf8\n" + figure.data;
    const auto add = [&](std::string_view terminal, std::string_view ending) {
        script +=
            fmt::format("set terminal {}\nset output '{}.{}'\n", terminal, figure.name, ending);
        script += fmt::format(
            "set label 999 {} at screen 0.01, screen 0.02 left font ',8' "
            "textcolor rgb '#606060'\n",
            gnuplot_string(shortened(figure.made_by)));
        script += fmt::format("set title {}\n", gnuplot_title(figure.title));
        script += figure.commands + "unset output\nreset\n";
    };
    add(fmt::format("svg size {},{} font 'sans-serif,12' background '#ffffff' noenhanced",
                    figure.width, figure.height),
        "svg");
    add(fmt::format("pngcairo size {:.0f},{:.0f} font 'Sans,9' fontscale {} linewidth {} "
                    "pointscale {} noenhanced",
                    png_scale * figure.width, png_scale * figure.height, png_scale, png_scale,
                    png_scale),
        "png");
    return script;
}

Gnuplot::Gnuplot() : program_(find_program("gnuplot")) {
    if (program_.empty()) {
        throw InputError("gnuplot is not in PATH: install the Debian package gnuplot-nox");
    }
}

void Gnuplot::draw(const Figure& figure, const fs::path& folder) const {
    const std::string script = figure.name + ".gp";
    replace_file(folder / script, gnuplot_script(figure));
    const fs::path log = folder / (figure.name + ".log");
    const ChildOutcome outcome =
        run_child({program_.string(), "--default-settings", script}, folder, log, time_limit_s);
    const bool whole = ends_with(folder / (figure.name + ".svg"), "</svg>") &&
                       ends_with(folder / (figure.name + ".png"), "IEND");
    if (!outcome.succeeded() || !whole) {
        const std::string words = last_lines(log, 3);
        throw InputError(fmt::format("gnuplot could not draw {}: {}", (folder / script).string(),
                                     words.empty() ? "is the disk full?" : words));
    }
    std::error_code ignored;
    fs::remove(log, ignored);
}

}  // namespace controlspace
