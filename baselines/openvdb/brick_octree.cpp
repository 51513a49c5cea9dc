// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/brick_octree.h"

#include <algorithm>
#include <cmath>

#include "controlspace/metric/blend.h"

namespace controlspace {

namespace {

// In a leaf with these corners, `i` of its edges' parts from the low one.
Metric between(const Corners& corners, const Cell& i, const Cell& edges,
               std::span<const Metric> metrics) {
    Vector t = Vector::Zero();
    std::size_t corner = 0;
    bool is_corner = true;
    for (std::size_t a = 0; a < 3; ++a) {
        if (i[a] == 0) continue;
        t[static_cast<Axis>(a)] = static_cast<double>(i[a]) / edges[a];
        corner |= std::size_t{1} << a;
        is_corner = is_corner && i[a] == edges[a];
    }
    if (is_corner) return metrics[corners[corner]];
    return blend_lengths(corner_weights(t),
                         [&](std::size_t c) -> const Metric& { return metrics[corners[c]]; });
}

}  // namespace

BrickLattice::BrickLattice(const Box& domain) {
    std::uint32_t vertices = 1;
    for (std::size_t a = 3; a-- > 0;) {
        const auto axis = static_cast<Axis>(a);
        cells_[a] = domain.low[axis] < domain.high[axis] ? most : 0;
        step_[a] = cells_[a] > 0 ? vertices : 0;
        vertices *= static_cast<std::uint32_t>(cells_[a] + 1);
        below_end_[a] = std::nextafter(cells_[a], 0.0);
    }
    vertices_ = vertices;
}

std::array<std::uint32_t, 8> BrickLattice::to_corners() const {
    std::array<std::uint32_t, 8> steps{};
    for (std::size_t c = 0; c < 8; ++c) {
        for (std::size_t a = 0; a < 3; ++a) steps[c] += (c >> a & 1) != 0 ? step_[a] : 0;
    }
    return steps;
}

std::uint32_t BrickLattice::number(const Cell& at) const {
    std::uint32_t number = 0;
    for (std::size_t a = 0; a < 3; ++a) number += static_cast<std::uint32_t>(at[a]) * step_[a];
    return number;
}

Bricks::Bricks(const Octants& tree) : Bricks(tree, tree.levels_below()) {}

Bricks::Bricks(const Octants& tree, const std::vector<std::uint8_t>& below)
    : levels(below.empty() ? 0 : std::min<int>(levels_of_brick, below.front())),
      cuts(tree, levels),
      boxes(cuts.bricks(tree.domain())) {
    parts.reserve(boxes.leaves.size());
    list(tree, below, tree.root(), 0);
}

void Bricks::list(const Octants& tree, const std::vector<std::uint8_t>& below, Ref ref, int at) {
    if (!ref.is_leaf() && below[ref.index()] > levels) {
        const OctreeNode& node = tree.node(ref);
        for (int c = 0; c < node.count(); ++c) {
            list(tree, below, node.children[node.slot(c)], at + 1);
        }
        return;
    }
    parts.push_back(ref);
    level.push_back(at);
}

BrickMetrics metrics_of_brick(const BrickOctree& octree, Ref brick, const BrickLattice& lattice) {
    BrickMetrics vertices;
    const auto enter = [&](LeafIndex leaf, const Cell& low, const Cell& edges) {
        const Corners& corners = octree.corners()[leaf];
        Cell i;
        for (i[0] = 0; i[0] <= edges[0]; ++i[0]) {
            for (i[1] = 0; i[1] <= edges[1]; ++i[1]) {
                for (i[2] = 0; i[2] <= edges[2]; ++i[2]) {
                    const Cell at{low[0] + i[0], low[1] + i[1], low[2] + i[2]};
                    vertices[lattice.number(at)] = between(corners, i, edges, octree.metrics());
                }
            }
        }
    };
    for_each_leaf_of_brick(octree.octants(), brick, {}, lattice.cells(), enter);
    return vertices;
}

}  // namespace controlspace
