// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// How lengths follow from the shape of a surface, all within bounds in the units of the file:
/// - along each principal direction of curvature κ the chord 2 sin(angle / 2) / |κ|, which spans
///   `angle` of the circle of curvature; across the surface the smaller of the two;
/// - across walls and gaps their thickness / elements_across.
///
/// Curvature is that of smooth patches, which end at creases: edges where the normal turns by more
/// than `crease`. Flat patches request h_max.
struct CurvatureSizes {
    double angle = 15;           ///< [degrees]
    double crease = 30;          ///< [degrees]
    double elements_across = 2;  ///< lengths across walls and gaps
    bool isotropic = false;      ///< the shortest length in all directions
    double h_min = 0;            ///< 0: a thousandth of the diagonal of the surface's box
    double h_max = 0;            ///< 0: a tenth of it

    bool operator==(const CurvatureSizes&) const = default;
};

/// Sources on a surface.
struct SurfaceSources {
    std::vector<PointSource> sources;
    std::size_t skipped = 0;  ///< vertices without a source: no triangle there has an area
    std::size_t fitted = 0;   ///< vertices whose curvature is fitted to the triangles
    std::size_t raised = 0;   ///< sources that would have a length below h_min
    double h_min = 0;         ///< that holds, in the units of the file
};

/// Sources at the vertices of a surface of polygons (.stl, .obj, .ply, .off), each vertex once, and
/// inside triangles with edges of a metric length of more than 2. Where patches meet, a vertex has
/// the intersection of their metrics. An apex, without a tangent plane, has h_min.
///
/// The distance across a wall or gap is measured along the normal, to surfaces that are parallel
/// within 30 degrees; of flanks that meet at a sharp edge within 20, with lengths down to h_min at
/// the edge: wider angles are filled with good elements in one layer.
///
/// Throws InputError that names the file for what cannot be read, where no triangle has an area,
/// and for angles, elements or bounds out of range.
///
/// CGAL does not validate files: a damaged one may crash it or exhaust memory. For files of
/// unknown origin call require_readable first (controlspace/io/require_readable.h).
SurfaceSources read_surface_sources(const std::filesystem::path& path,
                                    const CurvatureSizes& sizes = {});

}  // namespace controlspace
