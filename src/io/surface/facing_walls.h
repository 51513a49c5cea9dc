// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "io/surface/smooth_patches.h"

namespace controlspace {

/// What faces a place of a surface: the other side of a wall, or that of a gap.
class FacingWalls {
public:
    /// Keeps references to both.
    FacingWalls(const SurfaceMesh& mesh, const SmoothPatches& patches);
    ~FacingWalls();

    /// Distance from a place inside triangle `t` along its normal, on the side where it is shorter,
    /// to the next triangle, if that is parallel within 30 degrees; infinite where there is none.
    /// Within 20 degrees if both are of patches that meet at a crease: the flanks of a sharp edge,
    /// whose distance shrinks to nothing there. Meshers fill wider angles with good elements in one
    /// layer (Delaunay refinement keeps 20.7 degrees, Ruppert 1995), but not narrower ones.
    /// Triangles that touch are no gap, and neighbours across smooth edges no walls. Thread-safe.
    double distance(const Point& place, std::uint32_t t) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace controlspace
