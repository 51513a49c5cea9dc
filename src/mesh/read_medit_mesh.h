#pragma once

#include <filesystem>

#include "mesh/tet_mesh.h"

namespace controlspace {

/// Vertices, triangles and tetrahedra of an ASCII Medit file (.mesh), upright. Throws InputError
/// "name:line: what is wrong".
TetMesh read_medit_mesh(const std::filesystem::path& path);

}  // namespace controlspace
