#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "io/surface/surface_mesh.h"

namespace controlspace {

/// What faces a place of a surface: the other side of a wall, or that of a gap.
class FacingWalls {
public:
    /// Keeps references to both. `normals` of the triangles, on either side.
    FacingWalls(const SurfaceMesh& mesh, const std::vector<Vector>& normals);
    ~FacingWalls();

    /// Distance from a place inside triangle `t` along its normal, on the side where it is shorter,
    /// to the next triangle, if that is parallel within 30 degrees; infinite where there is none.
    /// Triangles that touch are no gap. Thread-safe.
    double distance(const Point& place, std::uint32_t t) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace controlspace
