// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Principal curvatures without sign, larger first: along the first two columns of `frame`, which
/// is orthonormal; the third is the normal.
struct Curvature {
    std::array<double, 2> along = {0, 0};
    Eigen::Matrix3d frame;
};

/// A surface of triangles, with the indices of their vertices; in no common orientation.
struct SurfaceMesh {
    std::vector<Point> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    double diagonal = 0;  ///< of the box around the vertices

    /// Curvatures that are known exactly, and for each corner of each triangle which of them is
    /// that of its face, or `unknown`. Empty where none is known.
    std::vector<Curvature> curvatures = {};
    std::vector<std::array<std::uint32_t, 3>> curvature_of = {};
    static constexpr std::uint32_t unknown = ~std::uint32_t{};
};

/// Largest distance that counts as round-off: coordinates of .stl files have 24 bits.
inline double rounding(const SurfaceMesh& mesh) { return 0x1p-23 * mesh.diagonal; }

/// Reads a surface of polygons (.stl, .obj, .ply, .off), which are cut into triangles; vertices
/// within round-off of each other are one: 1e-9 of the box's diagonal, in a binary .stl the spacing
/// of floats. Triangles whose height is rounding, which have no normal, are left out,
/// and so is the second of two with the same vertices. Throws InputError that names the file for
/// what cannot be read, for more vertices than the file has room for, and for one where no triangle
/// has an area.
SurfaceMesh read_surface_mesh(const std::filesystem::path& path);

/// The same surface in other units.
inline SurfaceMesh scaled(SurfaceMesh mesh, double factor) {
    for (Point& vertex : mesh.vertices) vertex *= factor;
    mesh.diagonal *= factor;
    for (Curvature& curvature : mesh.curvatures) {
        for (double& along : curvature.along) along /= factor;
    }
    return mesh;
}

struct SurfaceEdges {
    std::size_t count = 0;
    /// Those of an odd number of triangles, by their ends: none where the surface is closed.
    std::vector<std::array<std::uint32_t, 2>> open = {};
};
SurfaceEdges surface_edges(const SurfaceMesh& mesh);

}  // namespace controlspace
