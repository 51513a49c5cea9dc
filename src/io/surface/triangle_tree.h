// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <vector>

#include "io/surface/surface_mesh.h"

namespace controlspace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
/// Keeps iterators to the triangles, which must outlive it.
using TriangleTree = CGAL::AABB_tree<
    CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>>;

inline Kernel::Point_3 point_of(const Point& p) { return {p.x(), p.y(), p.z()}; }

inline Triangles triangles_of(const SurfaceMesh& mesh) {
    Triangles triangles;
    for (const auto& [a, b, c] : mesh.triangles) {
        triangles.emplace_back(point_of(mesh.vertices[a]), point_of(mesh.vertices[b]),
                               point_of(mesh.vertices[c]));
    }
    return triangles;
}

}  // namespace controlspace
