// SPDX-License-Identifier: Apache-2.0
// A mesh in binary Medit files against the same in ASCII.
#include <catch2/catch.hpp>

#include "controlspace/mesh/mesh_files.h"
#include "sources/files.h"
#include "sources/medit_bytes.h"

namespace controlspace::binary_mesh_test {

using Catch::Matchers::Contains;

namespace {

constexpr std::int32_t vertices_code = 4, triangles_code = 6, tetrahedra_code = 8;

/// The unit tetrahedron and one of its faces, the last of whose corners is `last`.
std::string unit_tet(int version, bool swapped, int last = 3) {
    MeditBytes file(version, swapped);
    const std::size_t n = file.integer_size();
    file.block(tetrahedra_code, n + 5 * n).integer(1);
    file.integer(1).integer(2).integer(3).integer(4).integer(9);
    file.block(vertices_code, n + 4 * (3 * file.real_size() + n)).integer(4);
    for (int i = 0; i < 4; ++i) {
        file.real(i == 1).real(i == 2).real(i == 3).integer(i);
    }
    file.block(triangles_code, n + 4 * n).integer(1);
    file.integer(1).integer(2).integer(last).integer(5);
    return file.end().bytes();
}

}  // namespace

TEST_CASE("binary meshes of all versions and byte orders are read") {
    const ScratchDirectory folder;
    const int version = GENERATE(1, 2, 3, 4);
    const bool swapped = GENERATE(false, true);
    CAPTURE(version, swapped);
    const TetMesh mesh = read_medit_mesh(folder.file("t.meshb", unit_tet(version, swapped)));
    CHECK(mesh.vertices == std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK(mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
    CHECK(mesh.tets == std::vector<Tetrahedron>{{0, 1, 2, 3}});
}

TEST_CASE("corners of binary meshes that are none are refused") {
    const ScratchDirectory folder;
    for (const int corner : {0, -1, 5, 2'000'000'000}) {
        const auto path = folder.file("t.meshb", unit_tet(2, false, corner));
        CHECK_THAT(error_of([&] { read_medit_mesh(path); }),
                   Contains("Triangles 1: " + std::to_string(corner) + " is not one of 1 to 4"));
    }
}

}  // namespace controlspace::binary_mesh_test
