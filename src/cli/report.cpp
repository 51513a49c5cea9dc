#include "cli/report.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <string>

#include "cli/paper.h"
#include "cli/readers.h"
#include "cli/signals.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
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

/// The sources may be gone since, or lie elsewhere; the rest of the report stands without them.
void add_fields_or_warn(Report& page, const ReportedResults& reported) {
    const StoredResults& results = reported.results;
    std::optional<SampledFields> fields;
    try {
        fields =
            sample_fields(results.study, first_setting(results.rows), structures(), file_readers());
    } catch (const InputError& error) {
        page.add_paragraph(fmt::format("Fields are not shown: {}.", error.what()));
        spdlog::warn("{}: fields are not shown: {}", reported.folder.string(), error.what());
    }
    if (fields) add_fields(page, reported, *fields);
}

}  // namespace

void report(const ReportOptions& options) {
    Interruption interruption;
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
    const Interruption::Watch watch(interruption, nullptr, [&] { page.abandon(); });
    for (std::size_t i = 1; i < all.size(); ++i) add_comparison(page, all.front(), all[i]);
    for (const ReportedResults& reported : all) {
        add_results(page, reported, styles);
        if (!options.without_fields) add_fields_or_warn(page, reported);
    }
    {
        const auto whole = interruption.postpone();
        page.commit("Control spaces: " + names);
    }
    print(fmt::format("Report: {}\n", page.page().string()));
}

}  // namespace controlspace
