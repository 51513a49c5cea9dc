// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controlspace/geometry/point.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {

/// Triangles around a vertex that follow each other across smooth edges: all of them inside a
/// patch, those of one patch at its boundary.
struct Fan {
    std::uint32_t vertex;
    std::vector<std::uint32_t> triangles;
    /// Unit normal, triangles weighted as on a sphere (Max 1999, "Weights for computing vertex
    /// normals from facet normals").
    Vector normal = Vector::Zero();
    bool closed = true;  ///< all around the vertex
    bool apex = false;   ///< no tangent plane: triangles are tilted by more than the angle (mean)
};

/// A surface divided into smooth patches by its creases: edges where the normal turns by more than
/// an angle, and those that do not belong to two triangles.
struct SmoothPatches {
    std::vector<Vector> normals;  ///< of triangles, unit; on one side within a patch
    /// Largest curvature across the smooth edges of a triangle: turn of the normal / height.
    std::vector<double> bends;
    std::vector<Fan> fans;
    std::vector<std::array<std::uint32_t, 3>> fan_of;  ///< of the corners of triangles
    std::vector<std::uint32_t> patch_of;               ///< of triangles
    /// Different patches with a crease in common, in ascending order.
    std::vector<std::array<std::uint32_t, 2>> meeting;

    /// Whether two triangles are of different patches that have a crease in common.
    bool meet(std::size_t t, std::size_t other) const;
};

/// Unit normals of triangles, each by its own vertices alone.
std::vector<Vector> triangle_normals(const SurfaceMesh& mesh);

/// `crease` in radians.
SmoothPatches smooth_patches(const SurfaceMesh& mesh, double crease);

}  // namespace controlspace
