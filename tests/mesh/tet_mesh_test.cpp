// SPDX-License-Identifier: Apache-2.0
#include "controlspace/mesh/tet_mesh.h"

#include <catch2/catch.hpp>
#include <set>

#include "mesh/fixtures.h"

namespace controlspace::tet_mesh_test {

TEST_CASE("each edge of a mesh comes once, in order") {
    const VertexIndex n = 3;
    const TetMesh mesh = kuhn_mesh(n);
    const std::vector<Edge> edges = edges_of(mesh);
    // Along the axes, across the faces of cells, and through the cells.
    CHECK(edges.size() == 3 * n * (n + 1) * (n + 1) + 3 * n * n * (n + 1) + n * n * n);
    CHECK(std::is_sorted(edges.begin(), edges.end()));
    CHECK(std::set<Edge>(edges.begin(), edges.end()).size() == edges.size());
    for (const auto& [a, b] : edges) REQUIRE(a < b);
}

TEST_CASE("volumes are signed, and turning upright makes them positive") {
    TetMesh mesh = kuhn_mesh(2);
    CHECK(volume(mesh) == Approx(1));
    const std::size_t turned = mesh.tets.size() / 2;
    for (std::size_t i = 0; i < turned; ++i) std::swap(mesh.tets[i][0], mesh.tets[i][1]);
    CHECK(volume(mesh) == Approx(0).margin(1e-12));
    turn_upright(mesh);
    CHECK(volume(mesh) == Approx(1));
    for (const Tetrahedron& tet : mesh.tets) CHECK(signed_volume(mesh, tet) == Approx(1.0 / 48));
}

}  // namespace controlspace::tet_mesh_test
