#pragma once

#include <array>

#include "io/surface/smooth_patches.h"

namespace controlspace {

/// Principal curvatures without sign, larger first: along the first two columns of `frame`, which
/// is orthonormal; the third is the normal.
struct Curvature {
    std::array<double, 2> along = {0, 0};
    Eigen::Matrix3d frame;
};

/// Curvature of a smooth patch at a fan: of the polynomial through the fan's vertex that fits the
/// vertices in two rings around it, and with little weight their normals, which decide what the
/// vertices leave open where they lie on two lines. 0 where the fan is flat up to rounding, and
/// infinite at an apex.
///
/// Heights are fitted over chords: a vertex at the distance d counts at the distance d in the
/// tangent plane. A sphere has its curvature then at any refinement.
Curvature curvature_at(const SurfaceMesh& mesh, const SmoothPatches& patches, const Fan& fan);

}  // namespace controlspace
