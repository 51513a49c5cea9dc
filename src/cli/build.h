#pragma once

#include <filesystem>

#include "cli/given_settings.h"

namespace controlspace {

/// What the command line of `build` asks for.
struct BuildOptions {
    std::filesystem::path input;   ///< study file or file of sources; empty: the paper's sphere
    std::filesystem::path output;  ///< .ctrl
    GivenSettings settings;        ///< they override the study file in all of its runs
    bool quiet = false;
};

/// Makes and grades the one structure that `options` ask for, K_oL if nothing is said, saves it,
/// and says on standard output what was saved. Throws InputError.
void build(const BuildOptions& options);

}  // namespace controlspace
