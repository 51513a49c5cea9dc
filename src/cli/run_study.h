#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/signals.h"
#include "controlspace/study/results.h"

namespace controlspace {

/// The outcome of a study that ran to its end.
struct FinishedStudy {
    std::vector<Row> rows;
    std::filesystem::path folder;  ///< of its results
};

struct RunOptions {
    std::string command_line;
    bool quiet = false;
    std::filesystem::path resume;  ///< folder of an interrupted run to continue, or empty
};

/// Runs `study` on all structures that it names, with progress on standard error unless quiet, and
/// its rows into a folder of results. Throws InputError for what cannot be run.
FinishedStudy run_study(const Study& study, const RunOptions& options, Interruption& interruption);

}  // namespace controlspace
