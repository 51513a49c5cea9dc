#pragma once

#include <filesystem>
#include <vector>

#include "controlspace/io/file_choice.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources at the vertices of a surface of polygons (.stl, .obj, .ply, .off), each vertex once. A
/// jet of second order is fitted to the vertices around; the length along each principal direction
/// of curvature κ is 2 sin(angle / 2) / |κ|, within h_min and h_max, and across the surface the
/// smaller of the two.
///
/// Throws InputError that names the file for what cannot be read; for a vertex where those around
/// do not determine the curvature; and for bounds or an angle that are none.
///
/// CGAL trusts what a file says: a damaged one may crash it, or take all memory. Read files of
/// unknown origin in a process of their own first, as the program does.
std::vector<PointSource> read_surface_sources(const std::filesystem::path& path,
                                              const CurvatureSizes& sizes = {});

}  // namespace controlspace
