#include "app/report.h"

#include <fmt/format.h>

#include <string>

#include "app/paper.h"
#include "app/standard_output.h"
#include "report/results_section.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

ReportedResults read_reported(const fs::path& folder, std::string prefix) {
    ReportedResults reported{folder, read_results(folder), {}, std::move(prefix)};
    const auto add = [&](const StoredResults& results) {
        reported.evidence.add(results.study, results.rows);
    };
    add(reported.results);
    for (const fs::path& nested : experiments_in(folder)) add(read_results(nested));
    return reported;
}

}  // namespace

void report(const ReportOptions& options) {
    std::vector<ReportedResults> all;
    std::vector<Row> rows;
    std::string names;
    for (const fs::path& folder : options.inputs) {
        const bool only = options.inputs.size() == 1;
        all.push_back(read_reported(folder, only ? "" : fmt::format("{}-", all.size() + 1)));
        const StoredResults& results = all.back().results;
        rows.insert(rows.end(), results.rows.begin(), results.rows.end());
        names += (names.empty() ? "" : ", ") + results.study.name;
    }
    const Styles styles(rows);
    Report page(options.output.empty() ? options.inputs.front() : options.output);
    for (const ReportedResults& reported : all) add_results(page, reported, styles);
    page.commit("Control spaces: " + names);
    print(fmt::format("Report: {}\n", page.page().string()));
}

}  // namespace controlspace
