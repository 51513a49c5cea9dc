#pragma once

#include <filesystem>

#include "controlspace/mesh/tet_mesh.h"

namespace controlspace {

/// Writes `mesh` as an ASCII Medit file (.mesh). Throws InputError if that fails; no part of a file
/// is left.
void write_medit_mesh(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace controlspace
