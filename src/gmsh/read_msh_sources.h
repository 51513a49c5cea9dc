#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources at the nodes of a mesh of Gmsh (`.msh`, format 4.1) that carry $NodeData, read by Gmsh:
/// sizes h (1 component) or Riemannian metrics M^-2 (9, by rows), of the first step in time. `view`
/// names the data; empty: the only ones. Throws InputError for what cannot be read so.
///
/// Gmsh trusts what a file says: a damaged one may crash it, or take all memory. Read files of
/// unknown origin in a process of their own first, as the program does.
std::vector<PointSource> read_msh_sources(const std::filesystem::path& path,
                                          const std::string& view = {});

}  // namespace controlspace
