// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "controlspace/io/read_sources.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources at the nodes of a mesh of Gmsh (.msh, format 4.1 or 2.x, text or binary) that carry
/// $NodeData, at the centres (means of the nodes) of elements that carry $ElementData, or at the
/// corners of those that carry $ElementNodeData: sizes h (1 component) or Riemannian metrics M^-2
/// (9, by rows), by ascending number of the node or element. Corners that elements share, with the
/// same value, make one source. `options` name the data and their step in time; without a name the
/// first of these three kinds that there is.
///
/// Throws InputError with the place for what cannot be read so, for counts that the file has no
/// room for, and for data that are no metrics.
std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// The same from `bytes`; `path` is used in messages.
std::vector<PointSource> parse_msh_sources(std::string_view bytes,
                                           const std::filesystem::path& path,
                                           const ReadOptions& options = {});

}  // namespace controlspace
