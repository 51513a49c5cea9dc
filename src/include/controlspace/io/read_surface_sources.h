#pragma once

#include <filesystem>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// How lengths follow from the curvature of a surface: along each principal direction of curvature
/// κ the chord 2 sin(angle / 2) / |κ|, which spans `angle` of the circle of curvature, within
/// bounds in the units of the file.
struct CurvatureSizes {
    double angle = 15;  ///< [degrees]
    double h_min = 0;   ///< 0: a thousandth of the diagonal of the surface's box
    double h_max = 0;   ///< 0: a tenth of it

    bool operator==(const CurvatureSizes&) const = default;
};

/// Sources at the vertices of a surface of polygons (.stl, .obj, .ply, .off), each vertex once. A
/// jet of second order is fitted to the vertices around each; across the surface the length is the
/// smaller of those along it.
///
/// Throws InputError that names the file for what cannot be read; for a vertex where those around
/// do not determine the curvature; and for bounds or an angle out of range.
///
/// CGAL trusts what a file says: a damaged one may crash it, or take all memory. Read files of
/// unknown origin in a process of their own first, as the program does.
std::vector<PointSource> read_surface_sources(const std::filesystem::path& path,
                                              const CurvatureSizes& sizes = {});

}  // namespace controlspace
