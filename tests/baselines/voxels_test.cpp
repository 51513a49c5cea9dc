// SPDX-License-Identifier: Apache-2.0
#include "baselines/lattice/voxels.h"

#include <catch2/catch.hpp>
#include <limits>

#include "controlspace/error.h"

namespace controlspace::voxels_test {
namespace {

// What a flat array of metrics takes; with gradation's copy, index and flag 101 bytes a node.
double flat_bytes(const Vector& nodes) { return nodes.prod() * sizeof(Metric); }
double bytes_with_gradation(const Vector& nodes) { return nodes.prod() * 101; }

SpaceOptions cube(double finest_length) {
    SpaceOptions options;
    options.domain = {Point(-1, -1, -1), Point(1, 1, 1)};
    options.finest_length = finest_length;
    return options;
}

SpaceOptions brick(double finest_length) {
    SpaceOptions options = cube(finest_length);
    options.domain.high = Point(2, 0.1, -0.9);
    return options;
}

}  // namespace

TEST_CASE("voxels are as fine as the finest leaf, and not finer than that needs") {
    SpaceOptions options = brick(0.07);
    options.l_min = 0.3;
    const double edge = options.l_min * options.finest_length;
    const Voxels voxels = choose_voxels(options, Interpolation::nearest, flat_bytes);
    for (Axis a = 0; a < 3; ++a) {
        const double length = options.domain.edges()[a];
        CHECK(length / voxels.cells[a] <= edge);
        CHECK(length / (voxels.cells[a] - 1) > edge);
    }
    CHECK(voxels.remark.empty());
}

TEST_CASE("voxels that are set need no finest length") {
    SpaceOptions options = cube(0);
    options.voxel = 0.1;
    CHECK(choose_voxels(options, Interpolation::nearest, flat_bytes).cells == Vector(20, 20, 20));
    options.finest_length = 0.05;
    CHECK(choose_voxels(options, Interpolation::nearest, flat_bytes).cells == Vector(20, 20, 20));
    options.voxel = -0.1;
    CHECK_THROWS_WITH(choose_voxels(options, Interpolation::nearest, flat_bytes),
                      Catch::Contains("voxel is -0.1"));
}

TEST_CASE("rounding does not add a cell") {
    for (const double n : {3, 7, 10, 49, 100, 125, 333}) {
        const Voxels voxels = choose_voxels(cube(2 / n), Interpolation::nearest, flat_bytes);
        CHECK(voxels.cells == Vector(n, n, n));
    }
}

TEST_CASE("a grid has a node per cell or per vertex") {
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    CHECK(lattice_nodes(box, Vector(4, 5, 6), Interpolation::nearest) == Vector(4, 5, 6));
    CHECK(lattice_nodes(box, Vector(4, 5, 6), Interpolation::trilinear) == Vector(5, 6, 7));
    const Box flat{Point(0, 2, 0), Point(1, 2, 1)};
    CHECK(lattice_nodes(flat, Vector(4, 1, 6), Interpolation::nearest) == Vector(4, 1, 6));
    CHECK(lattice_nodes(flat, Vector(4, 1, 6), Interpolation::trilinear) == Vector(5, 1, 7));
}

TEST_CASE("under a memory cap the finest grid that fits is taken, and said") {
    SpaceOptions options = cube(2.0 / 1024);
    options.max_bytes = std::size_t{512} * 512 * 512 * 101;
    const Voxels voxels = choose_voxels(options, Interpolation::nearest, flat_bytes);
    CHECK(voxels.cells == Vector(512, 512, 512));
    CHECK(voxels.remark == "512^3; 1024^3 would need 108 GB");

    // One byte less, and the grid is coarser; vertices take more room than cells.
    --options.max_bytes;
    CHECK(choose_voxels(options, Interpolation::nearest, flat_bytes).cells.x() == 511);
    CHECK(choose_voxels(options, Interpolation::trilinear, flat_bytes).cells.x() == 510);
}

TEST_CASE("under a memory cap cells are cut along the longest edge as often as fits") {
    SpaceOptions options = brick(1e-4);
    options.max_bytes = std::size_t{10} << 20;
    const auto interpolation = GENERATE(Interpolation::nearest, Interpolation::trilinear);
    const Voxels voxels = choose_voxels(options, interpolation, flat_bytes);
    const auto bytes = [&](double n) {
        const Vector edges = options.domain.edges();
        const Vector cells = (edges / edges.x() * n).array().ceil();
        return bytes_with_gradation(lattice_nodes(options.domain, cells, interpolation));
    };
    const auto cap = static_cast<double>(options.max_bytes);
    CHECK(bytes_with_gradation(lattice_nodes(options.domain, voxels.cells, interpolation)) <= cap);
    CHECK(bytes(voxels.cells.x()) <= cap);
    CHECK(bytes(voxels.cells.x() + 1) > cap);
    CHECK_THAT(voxels.remark, Catch::Contains("; 30000 x 11000 x 1000 would need 33."));
}

TEST_CASE("nodes are fewer than 32 bits can number, whatever the cap") {
    SpaceOptions options = cube(1e-6);
    options.max_bytes = std::numeric_limits<std::size_t>::max();
    const Voxels voxels = choose_voxels(options, Interpolation::nearest, flat_bytes);
    CHECK(voxels.cells == Vector(1625, 1625, 1625));  // 1625^3 < 2^32 < 1626^3
}

TEST_CASE("a finest length so small that cells overflow still gives a grid") {
    SpaceOptions options = cube(1e-300);
    options.max_bytes = 101 * 1000;
    CHECK(choose_voxels(options, Interpolation::nearest, flat_bytes).cells == Vector(10, 10, 10));
}

TEST_CASE("voxels larger than the domain are one cell") {
    CHECK(choose_voxels(brick(50), Interpolation::nearest, flat_bytes).cells == Vector(1, 1, 1));
}

TEST_CASE("a grid refuses options that give it no voxels") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    for (const double finest_length : {0.0, -1.0, nan, infinite}) {
        CHECK_THROWS_AS(choose_voxels(cube(finest_length), Interpolation::nearest, flat_bytes),
                        InputError);
    }
    SpaceOptions options = cube(0.1);
    options.max_bytes = 100;
    CHECK_THROWS_WITH(choose_voxels(options, Interpolation::nearest, flat_bytes),
                      Catch::Contains("100 B") && Catch::Contains("101 B"));
    options.domain.high.x() = options.domain.low.x();
    CHECK_THROWS_AS(choose_voxels(options, Interpolation::nearest, flat_bytes), InputError);
}

}  // namespace controlspace::voxels_test
