#pragma once

#include <filesystem>
#include <string>

#include "report/report.h"
#include "report/sampled_fields.h"
#include "report/style.h"
#include "study/paper_evidence.h"
#include "study/read_results.h"

namespace controlspace {

/// One folder of results, as a report shows it.
struct ReportedResults {
    std::filesystem::path folder;
    StoredResults results;
    PaperEvidence evidence;  ///< with the experiments that lie there
    std::string prefix;      ///< of the names of its pictures
};

/// All that its rows say: where they are from, fronts, the paper's tables with verdicts, creation
/// and access times, and every measure.
void add_results(Report& report, const ReportedResults& reported, const Styles& styles);

/// What changed from the one to the other: rows of the same setting, after over before.
void add_comparison(Report& report, const ReportedResults& before, const ReportedResults& after);

/// What `fields` look like: slices, δ over the domain, and the structures against each other.
void add_fields(Report& report, const ReportedResults& reported, const SampledFields& fields);

}  // namespace controlspace
