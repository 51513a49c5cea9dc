#pragma once

#include <filesystem>
#include <string>

#include "cli/given_settings.h"
#include "study/study.h"

namespace controlspace {

/// What the command line of `compare` asks for.
struct CompareOptions {
    std::filesystem::path study_file;  ///< empty: the built-in study
    GivenSettings settings;            ///< they override the study file in all of its runs
    bool as_published = false;
    std::filesystem::path resume;  ///< folder of an interrupted run to go on with, or empty
    bool dry_run = false;          ///< say what would be run
    bool quiet = false;
    std::string command_line;
};

/// The study that `options` ask for. Throws InputError.
Study study_of(const CompareOptions& options);

/// Runs the study, with progress on standard error and tables on standard output. Returns whether
/// all cases succeeded; the rows of those that did not say why.
bool compare(const CompareOptions& options);

}  // namespace controlspace
