// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/surface/smooth_patches.h"

namespace controlspace {

/// Curvature of a smooth patch at a fan: of the polynomial through the fan's vertex that fits the
/// vertices in two rings around it, and with little weight their normals, which decide what the
/// vertices leave open where they lie on two lines. 0 where the fan is flat up to rounding, and
/// infinite at an apex.
///
/// Heights are fitted over chords: a vertex at the distance d counts at the distance d in the
/// tangent plane. A sphere has its curvature then at any refinement.
Curvature curvature_at(const SurfaceMesh& mesh, const SmoothPatches& patches, const Fan& fan);

}  // namespace controlspace
