// SPDX-License-Identifier: Apache-2.0
#include "io/openvdb/sampled_block.h"

#include <algorithm>
#include <cmath>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/intersection.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr std::int32_t side = SampledBlock::side;

/// A cube of voxels within a block.
struct Cube {
    std::int32_t i, j, k, edge;

    /// Calls visit(voxel, i, j, k).
    template <class Visit>
    void for_each(Visit&& visit) const {
        for (std::int32_t a = i; a < i + edge; ++a) {
            for (std::int32_t b = j; b < j + edge; ++b) {
                for (std::int32_t c = k; c < k + edge; ++c) {
                    visit(SampledBlock::index(a, b, c), a, b, c);
                }
            }
        }
    }
    template <class Holds>
    bool all_of(Holds&& holds) const {
        bool all = true;
        for_each([&](std::size_t v, auto...) { all = all && holds(v); });
        return all;
    }
    Cube child(int number) const {
        const std::int32_t half = edge / 2;
        return {i + (number >> 2 & 1) * half, j + (number >> 1 & 1) * half, k + (number & 1) * half,
                half};
    }
};

Metric mean_of(const SampledBlock& block, const Cube& cube) {
    Metric sum{0, 0, 0, 0, 0, 0};
    cube.for_each([&](std::size_t v, auto...) {
        const Metric& m = block.metrics[v];
        sum = {sum.xx + m.xx, sum.yy + m.yy, sum.zz + m.zz,
               sum.xy + m.xy, sum.xz + m.xz, sum.yz + m.yz};
    });
    return 1.0 / (cube.edge * cube.edge * cube.edge) * sum;
}

/// `most`: the factor between lengths.
void settle(SampledBlock& block, const Cube& cube, double most) {
    const std::size_t first = SampledBlock::index(cube.i, cube.j, cube.k);
    if (cube.edge == 1) {
        block.same_as[first] = static_cast<std::uint16_t>(first);
        return;
    }
    Metric shared = block.metrics[first];
    // A mean of what is the same would differ by rounding.
    bool one = cube.all_of([&](std::size_t v) { return block.metrics[v] == shared; });
    if (!one && most > 1) {
        shared = mean_of(block, cube);
        one = cube.all_of([&](std::size_t v) {
            const Metric& m = block.metrics[v];
            return is_within(shared, most, m) && is_within(m, most, shared);
        });
    }
    if (one) {
        cube.for_each([&](std::size_t v, auto...) {
            block.metrics[v] = shared;
            block.same_as[v] = static_cast<std::uint16_t>(first);
        });
        return;
    }
    for (int child = 0; child < 8; ++child) settle(block, cube.child(child), most);
}

}  // namespace

VoxelLattice voxel_lattice(const Box& domain, double voxel) {
    constexpr double default_count = 128;
    constexpr double most = 4294967296.0;
    const double longest = require_extent(domain).edges().maxCoeff();
    if (voxel == 0) voxel = longest / default_count;
    if (!std::isfinite(voxel) || voxel < 0) refuse("a voxel of {}: give a positive edge", voxel);
    // 2 / 0.02 voxels should be 100, whichever way the quotient is rounded.
    const Vector counts = (domain.edges().array() / voxel * (1 - 1e-12)).ceil().max(1);
    if (!(counts.prod() <= most) || counts.maxCoeff() > most / 4) {
        refuse("voxels of {} are more than 2^32 in the domain {}: give larger ones (--voxel)",
               voxel, to_string(domain));
    }
    VoxelLattice lattice{domain, voxel, {}};
    for (std::size_t a = 0; a < 3; ++a) {
        lattice.counts[a] = static_cast<std::int32_t>(counts[static_cast<Axis>(a)]);
    }
    return lattice;
}

void sample_block(const ControlSpace& field, const VoxelLattice& lattice,
                  const std::array<std::int32_t, 3>& first, double tolerance, SampledBlock& block) {
    constexpr Cube whole{0, 0, 0, side};
    std::array<Point, SampledBlock::size> points;
    const auto at = [&](std::size_t axis, std::int32_t offset) {
        return std::min(first[axis] + offset, lattice.counts[axis] - 1);
    };
    whole.for_each([&](std::size_t v, std::int32_t i, std::int32_t j, std::int32_t k) {
        points[v] = lattice.centre(at(0, i), at(1, j), at(2, k));
    });
    field.sample(points, block.metrics);
    for (std::size_t v = 0; v < SampledBlock::size; ++v) {
        if (is_positive_definite(block.metrics[v])) continue;
        const Point& x = points[v];
        refuse(
            "the field at ({}, {}, {}) is {}, which is not positive definite: export "
            "another structure",
            x.x(), x.y(), x.z(), to_string(block.metrics[v]));
    }
    settle(block, whole, 1 + tolerance);
}

}  // namespace controlspace
