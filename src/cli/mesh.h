#pragma once

#include <filesystem>
#include <string>

#include "cli/given_settings.h"

namespace controlspace {

/// What the command line of `mesh` asks for.
struct MeshOptions {
    /// Study file, file of sources, or a control space that was saved; empty: the paper's sphere.
    std::filesystem::path input;
    GivenSettings settings;  ///< of the study, of its runs, and of the meshing
    bool quiet = false;
    std::string command_line;
};

/// Makes a mesh of each case of the study, and one of each exact field to compare with, into a new
/// folder, and prints how they conform; or the one mesh of a control space that was saved, and how
/// it conforms to that. Returns whether all succeeded; the rows of those that did
/// not say why. Throws InputError.
bool mesh(const MeshOptions& options);

}  // namespace controlspace
