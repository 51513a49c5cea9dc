#pragma once

#include <filesystem>

#include "controlspace/mesh/tet_mesh.h"

namespace controlspace {

/// Writes `mesh` in Gmsh's own format, by Gmsh (see GmshSession). Throws InputError if that fails;
/// no part of a file is left.
void write_msh(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace controlspace
