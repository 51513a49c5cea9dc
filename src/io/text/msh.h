#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources at the nodes of a mesh of Gmsh (.msh, format 4.1, text or binary) that carry $NodeData,
/// or at the centres (means of the nodes) of elements that carry $ElementData: sizes h (1
/// component) or Riemannian metrics M^-2 (9, by rows), of the first step in time, by ascending
/// number of the node or element. `view` names the data, those of nodes first; empty: the only ones
/// of nodes, or of elements where nodes have none.
///
/// Throws InputError with the place for what cannot be read so, for counts that the file has no
/// room for, and for data that are no metrics.
std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const std::string& view = {});

/// The same from `bytes`; `path` is used in messages.
std::vector<PointSource> parse_msh_sources(std::string_view bytes,
                                           const std::filesystem::path& path,
                                           const std::string& view = {});

}  // namespace controlspace
