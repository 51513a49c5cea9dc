#pragma once

#include <filesystem>

#include "cli/given_settings.h"

namespace controlspace {

/// What the command line of `query` asks for.
struct QueryOptions {
    std::filesystem::path input;   ///< study file, file of sources, or .ctrl
    std::filesystem::path points;  ///< .csv with the places
    std::filesystem::path output = "/dev/stdout";
    GivenSettings settings;  ///< they override the study file in all of its runs
    bool quiet = false;
};

/// Makes and grades, or loads, the one structure that `options` ask for, K_oL if nothing is said,
/// and writes its metrics at the places as a table of sources. Throws InputError.
void query(const QueryOptions& options);

}  // namespace controlspace
