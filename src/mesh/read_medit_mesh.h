#pragma once

#include <filesystem>

#include "controlspace/mesh/tet_mesh.h"

namespace controlspace {

/// Vertices, triangles and tetrahedra of a Medit file (.mesh, .meshb), upright. Throws InputError
/// that names the place.
TetMesh read_medit_mesh(const std::filesystem::path& path);

}  // namespace controlspace
