#include "report/results_section.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/comparison.h"
#include "report/delta_figures.h"
#include "report/pareto_figures.h"
#include "report/slice_figures.h"
#include "report/time_figures.h"
#include "study/paper_page.h"
#include "study/pareto.h"
#include "study/results.h"
#include "study/tables.h"

namespace controlspace {
namespace {

TextTable origin_table(const StoredResults& results) {
    const Provenance& p = results.provenance;
    const auto failed = std::count_if(results.rows.begin(), results.rows.end(),
                                      [](const Row& row) { return !row.measures; });
    TextTable table{"Where it is from", "", {{"what", Align::left}, {"value", Align::left}}, {}};
    table.rows = {
        {"program", version_text(p)},
        {"commit", p.commit},
        {"compiler", p.compiler},
        {"flags", p.flags},
        {"processor", p.cpu},
        {"cores, threads", fmt::format("{}, {}", p.cores, p.threads)},
        {"date (UTC)", p.date},
        {"command", p.command_line},
        {"sources, seed",
         fmt::format("{}, {}", sources_name(results.study.sources), results.study.seed)},
        {"rows", fmt::format("{}, {} failed{}", results.rows.size(), failed,
                             results.complete ? "" : "; not complete: cases are missing")}};
    return table;
}

void add_paper(Report& report, const ReportedResults& reported, const Styles& styles,
               const std::string& made_by) {
    if (reported.evidence.cells().empty()) return;
    report.add_subheading("The paper's tables");
    report.add_paragraph(paper_headline(reported.evidence));
    report.add_figures(paper_figures(reported.evidence, styles, reported.prefix, made_by));
    report.add_tables(paper_summary_tables(reported.evidence));
    report.add_tables(paper_comparison(reported.results.study, reported.results.rows));
    report.add_tables(paper_detail_tables(reported.evidence));
}

}  // namespace

void add_results(Report& report, const ReportedResults& reported, const Styles& styles) {
    const auto& [provenance, study, rows, complete] = reported.results;
    const std::string& prefix = reported.prefix;
    const std::string& made_by = provenance.command_line;
    const auto add = [&](std::string_view title, const std::vector<Figure>& figures) {
        if (figures.empty()) return;
        report.add_subheading(title);
        report.add_figures(figures);
    };
    report.add_heading(fmt::format("{} ({})", study.name, reported.folder.string()));
    report.add_tables(std::vector{origin_table(reported.results)});
    add("Error against memory and access time", pareto_figures(rows, styles, prefix, made_by));
    report.add_tables(pareto_tables(rows));
    add_paper(report, reported, styles, made_by);
    add("Creation time", creation_figures(rows, styles, prefix, made_by));
    add("Access time", access_figures(rows, prefix, made_by));
    report.add_tables(measure_tables(rows));
}

void add_comparison(Report& report, const ReportedResults& before, const ReportedResults& after) {
    const auto pairs = row_pairs(before.results.rows, after.results.rows);
    report.add_heading(fmt::format("{} after {}", after.folder.string(), before.folder.string()));
    const Provenance& a = before.results.provenance;
    const Provenance& b = after.results.provenance;
    report.add_paragraph(
        fmt::format("{} rows of {} have the same setting as one of {}. Before: {}, {}, {}. After: "
                    "{}, {}, {}.{}",
                    pairs.size(), before.results.rows.size(), after.results.rows.size(),
                    version_text(a), a.cpu, a.date, version_text(b), b.cpu, b.date,
                    a.cpu == b.cpu ? "" : " The machines differ: so do times."));
    const std::string differing = differing_settings(before.results.study, after.results.study);
    if (!differing.empty()) {
        report.add_paragraph("The studies differ: " + differing +
                             ". What depends on these cannot be compared.");
    }
    if (pairs.empty()) return;
    report.add_tables(std::vector{change_counts(pairs)});
    report.add_figures(change_figures(pairs, after.prefix, a.command_line + "; " + b.command_line));
    report.add_tables(change_tables(pairs));
}

void add_fields(Report& report, const ReportedResults& reported, const SampledFields& fields) {
    const std::string& made_by = reported.results.provenance.command_line;
    report.add_heading("Fields of " + reported.results.study.name);
    report.add_paragraph(
        "Structures of the first setting, each with its first split, made anew for this report.");
    for (const std::string& why : fields.left_out) report.add_paragraph("Left out: " + why + ".");
    if (fields.structures.empty()) return;
    report.add_figures(
        std::vector{delta_histograms(fields, reported.prefix + "delta", made_by),
                    cross_validation(fields, reported.prefix + "cross-validation", made_by)});
    report.add_tables(std::vector{delta_table(fields)});
    report.add_figures(slice_figures(fields, reported.prefix, made_by));
}

}  // namespace controlspace
