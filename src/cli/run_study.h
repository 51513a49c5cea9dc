#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/signals.h"
#include "study/provenance.h"
#include "study/row.h"
#include "study/study.h"

namespace controlspace {

/// What is left of a study that ran to its end.
struct FinishedStudy {
    Study study;
    std::vector<Row> rows;
    Provenance provenance;
    std::filesystem::path folder;  ///< where its results are
};

struct RunOptions {
    std::string command_line;
    bool quiet = false;
    std::filesystem::path resume;  ///< folder of an interrupted run to go on with, or empty
};

/// Runs `study` on all structures that it names, with progress on standard error unless quiet,
/// and keeps its folder of results up to date. Throws InputError for what cannot be run.
FinishedStudy run_study(const Study& study, const RunOptions& options, Interruption& interruption);

}  // namespace controlspace
