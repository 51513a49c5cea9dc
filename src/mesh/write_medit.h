#pragma once

#include <filesystem>
#include <span>

#include "mesh/tet_mesh.h"
#include "metric/metric.h"

namespace controlspace {

/// Writes `mesh` as an ASCII Medit file (.mesh). Throws InputError if that fails; no part of a file
/// is left.
void write_medit_mesh(const std::filesystem::path& path, const TetMesh& mesh);

/// Writes `metrics`, those of a mesh's vertices in their order, as an ASCII Medit solution (.sol):
/// one symmetric tensor each, the Riemannian metric M^-2 by its lower triangle, xx xy yy xz yz zz,
/// as MMG, refine and read_medit_sources take it. Throws as above.
void write_medit_solution(const std::filesystem::path& path, std::span<const Metric> metrics);

}  // namespace controlspace
