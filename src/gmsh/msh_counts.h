#pragma once

#include <filesystem>
#include <string_view>

namespace controlspace {

/// Throws InputError unless `bytes`, a file of Gmsh, is of format 4.1 and has room for what its
/// nodes, elements and data are said to be: Gmsh allocates whatever a file says.
void require_plausible_msh(std::string_view bytes, const std::filesystem::path& path);

}  // namespace controlspace
