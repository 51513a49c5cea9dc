#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "report/figure.h"
#include "study/text_table.h"

namespace controlspace {

/// A page that is put together from top to bottom, and its pictures. Nothing is seen of either
/// before `commit`, and nothing is left of them without it.
class Report {
public:
    /// Throws InputError where gnuplot is missing or `folder` cannot be made or written to.
    explicit Report(std::filesystem::path folder);
    ~Report();
    Report(const Report&) = delete;
    Report& operator=(const Report&) = delete;

    void add_heading(std::string_view title);  ///< named at the top of the page too
    void add_subheading(std::string_view title);
    void add_paragraph(std::string_view text);
    /// Draws them. Throws InputError as Gnuplot::draw does.
    void add_figures(std::span<const Figure> figures);
    void add_tables(std::span<const TextTable> tables);

    /// Writes FOLDER/report.html and FOLDER/report-pictures/, where files of the same names are
    /// replaced. Throws InputError, naming the file. To be called once, last.
    void commit(std::string_view title);

    /// Removes what was drawn: for a program that is ended before `commit`.
    void abandon() const;

    /// The page that `commit` writes.
    std::filesystem::path page() const { return folder_ / "report.html"; }

private:
    const Gnuplot gnuplot_;
    const std::filesystem::path folder_;
    const std::filesystem::path drawn_;  ///< pictures until `commit`
    std::string contents_;
    std::string body_;
    int headings_ = 0;
};

}  // namespace controlspace
