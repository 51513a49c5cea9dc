// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

using VertexIndex = std::uint32_t;
using Edge = std::array<VertexIndex, 2>;
using Triangle = std::array<VertexIndex, 3>;
using Tetrahedron = std::array<VertexIndex, 4>;

/// A mesh of tetrahedra in the units of the domain.
struct TetMesh {
    std::vector<Point> vertices;
    std::vector<Triangle> triangles;  ///< of the boundary
    std::vector<Tetrahedron> tets;    ///< of positive volume
};

/// The six edges of a tetrahedron, as places in it.
inline constexpr std::array<std::array<std::size_t, 2>, 6> tet_edges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// Each edge of the tetrahedra once, the smaller index first, in ascending order.
std::vector<Edge> edges_of(const TetMesh& mesh);

/// Volume of the tetrahedron with these corners; negative if it stands on its head.
double signed_volume(const Point& a, const Point& b, const Point& c, const Point& d);
double signed_volume(const TetMesh& mesh, const Tetrahedron& tet);

/// Swaps two corners of each tetrahedron whose volume is negative.
void turn_upright(TetMesh& mesh);

/// Total volume of the tetrahedra.
double volume(const TetMesh& mesh);

}  // namespace controlspace
