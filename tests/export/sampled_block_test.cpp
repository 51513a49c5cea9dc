// SPDX-License-Identifier: Apache-2.0
#include "io/openvdb/sampled_block.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "export/fixtures.h"

namespace controlspace::sampled_block_test {

using Catch::Matchers::Contains;

namespace {

SampledBlock sampled(const ControlSpace& field, const VoxelLattice& lattice,
                     const std::array<std::int32_t, 3>& first, double tolerance) {
    SampledBlock block;
    sample_block(field, lattice, first, tolerance, block);
    return block;
}

/// By which lengths along one direction differ: singular values of a^-1 b, as vectors whose length
/// is 1 in one metric have those lengths in the other.
double largest_factor(const Metric& a, const Metric& b) {
    const Eigen::Matrix3d change = a.matrix().inverse() * b.matrix();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares(change * change.transpose());
    return std::sqrt(std::max(squares.eigenvalues()[2], 1 / squares.eigenvalues()[0]));
}

/// A thin metric, 100:1, that turns from place to place.
Metric turning(const Point& x) {
    const Eigen::AngleAxisd turn(0.01 * x.x(), Vector(1, 2, 3).normalized());
    return metric_from_frame({0.3, 0.3, 0.003}, turn.toRotationMatrix());
}

std::size_t distinct(const SampledBlock& block) {
    return std::set<std::uint16_t>(block.same_as.begin(), block.same_as.end()).size();
}

}  // namespace

TEST_CASE("a plane is one layer of voxels, whose places are on it") {
    const VoxelLattice lattice = voxel_lattice({Point(0, 2, 1), Point(1, 2, 3)}, 0.1);
    CHECK(lattice.counts == std::array{10, 1, 20});
    CHECK(lattice.centre(3, 0, 4).y() == 2);
}

TEST_CASE("a block keeps within the tolerance of the field, voxel by voxel") {
    const VoxelLattice lattice = voxel_lattice(two_cube, 1.0 / 32);
    REQUIRE(lattice.counts == std::array{64, 64, 64});
    const auto at = GENERATE(around_sphere, turning);
    const FormulaField field(at);
    const double tolerance = GENERATE(0.0, 0.001, 0.01, 0.1, 0.7);
    const std::array<std::int32_t, 3> first{40, 24, 32};
    const SampledBlock block = sampled(field, lattice, first, tolerance);
    double largest = 1;  // factor of lengths in any direction
    for (std::int32_t i = 0; i < 8; ++i) {
        for (std::int32_t j = 0; j < 8; ++j) {
            for (std::int32_t k = 0; k < 8; ++k) {
                const std::size_t v = SampledBlock::index(i, j, k);
                const Point x =
                    Point::Constant(-1) +
                    Vector(first[0] + i + 0.5, first[1] + j + 0.5, first[2] + k + 0.5) / 32;
                largest = std::max(largest, largest_factor(block.metrics[v], at(x)));
                CHECK(block.metrics[v] == block.metrics[block.same_as[v]]);
                CHECK(block.same_as[v] <= v);
            }
        }
    }
    CHECK(largest <= 1 + tolerance + 1e-9);
    if (tolerance == 0) CHECK(distinct(block) == 512);
    if (tolerance == 0.1) CHECK(distinct(block) < 512);
}

TEST_CASE("a field that is the same everywhere is one metric, to the bit") {
    const FormulaField field([](const Point&) { return Metric{0.1, 0.2, 0.3, 0.01, 0.02, 0.03}; });
    const SampledBlock block = sampled(field, voxel_lattice(two_cube, 0.1), {0, 0, 0}, 0.02);
    CHECK(block.same_as == decltype(block.same_as){});
    CHECK(block.metrics[511] == Metric{0.1, 0.2, 0.3, 0.01, 0.02, 0.03});
}

TEST_CASE("voxels beyond the lattice ask for nothing beyond the domain") {
    const FormulaField field([](const Point& x) {
        CHECK(two_cube.contains(x));
        return around_sphere(x);
    });
    const VoxelLattice lattice = voxel_lattice(two_cube, 0.3);
    CHECK(lattice.counts == std::array{7, 7, 7});
    const SampledBlock block = sampled(field, lattice, {0, 0, 0}, 0);
    CHECK(block.metrics[SampledBlock::index(7, 7, 7)] ==
          block.metrics[SampledBlock::index(6, 6, 6)]);
}

TEST_CASE("lattices: the default, whole quotients, and what is out of range") {
    CHECK(voxel_lattice({{0, 0, 0}, {4, 2, 1}}, 0).counts == std::array{128, 64, 32});
    CHECK(voxel_lattice({{0, 0, 0}, {1, 0.3, 0.7}}, 0.1).counts == std::array{10, 3, 7});
    for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        CHECK_THAT(error_of([&] { voxel_lattice(two_cube, bad); }), Contains("positive"));
    }
    CHECK_THAT(error_of([] { voxel_lattice(two_cube, 1e-4); }), Contains("--voxel"));
    CHECK_THAT(error_of([] { voxel_lattice(two_cube, 1e-300); }), Contains("--voxel"));
}

TEST_CASE("what is no metric is refused, with its place") {
    const FormulaField field([](const Point& x) { return Metric::isotropic(x.x()); });
    const auto error = error_of([&] {
        sampled(field, voxel_lattice(two_cube, 0.25), {0, 0, 0}, 0.02);
    });
    CHECK_THAT(error, Contains("(-0.875, -0.875, -0.875)") && Contains("not positive definite"));
}

}  // namespace controlspace::sampled_block_test
