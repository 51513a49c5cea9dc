#pragma once

#include <filesystem>
#include <span>

#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Whether a Medit file of that name is binary: it ends in .meshb or .solb.
bool is_binary_medit_name(const std::filesystem::path& path);

/// Writes `metrics`, those of a mesh's vertices in their order, as a Medit solution, ASCII (.sol)
/// or binary (.solb, version 2, or 3 beyond 2 GiB): one symmetric tensor each, the Riemannian
/// metric M^-2 by its lower triangle, xx xy yy xz yz zz, as MMG, refine and read_medit_sources take
/// it. Throws InputError if that fails; no part of a file is left.
void write_medit_solution(const std::filesystem::path& path, std::span<const Metric> metrics);

/// Writes `sources` as two files, of which `path` names one (.mesh, .sol, .meshb or .solb): a mesh
/// of vertices alone and its solution, of sizes where all sources are isotropic and of tensors
/// otherwise. Throws as above.
void write_medit_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

}  // namespace controlspace
