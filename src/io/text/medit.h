// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

// Medit's files store the Riemannian metric M^-2 as xx xy yy xz yz zz, or a scalar, the length h.
// The text forms are .mesh and .sol, the binary ones .meshb and .solb (MeditReader).

/// Sources at the vertices of a mesh, with the metrics of its solution: one field, of scalars or
/// of symmetric tensors. Throws InputError with the place (MeditReader), and IndefiniteTensors.
std::vector<PointSource> read_medit_sources(const std::filesystem::path& mesh,
                                            const std::filesystem::path& solution);

/// Sources at the ends of a mesh's required edges, each with the mean length of those that end
/// there: sizes that fit a boundary which remeshing keeps. Throws InputError.
std::vector<PointSource> read_medit_required_edges(const std::filesystem::path& mesh);

/// The vertices alone.
std::vector<Point> read_medit_vertices(const std::filesystem::path& mesh);

/// The readers for contents in memory; the paths are for messages.
std::vector<PointSource> parse_medit_required_edges(std::string_view bytes,
                                                    const std::filesystem::path& mesh);
std::vector<Point> parse_medit_vertices(std::string_view bytes, const std::filesystem::path& path);
std::vector<Metric> parse_medit_metrics(std::string_view bytes, const std::filesystem::path& path);

/// Writes `metrics`, those of a mesh's vertices in their order, as a solution of tensors, as MMG
/// and refine read it; of sizes where all are isotropic, unless tensors are to be kept. Throws
/// InputError if that fails; no part of a file is left.
void write_medit_solution(const std::filesystem::path& path, std::span<const Metric> metrics,
                          bool keep_tensors = false);

/// Writes `sources` as two files, of which `path` names one (.mesh, .sol, .meshb or .solb): a mesh
/// of vertices alone and its solution, of sizes where all sources are isotropic and of tensors
/// otherwise. Throws as above.
void write_medit_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

}  // namespace controlspace
