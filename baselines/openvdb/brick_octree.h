// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "baselines/openvdb/brick_codes.h"
#include "baselines/openvdb/octree_voxels.h"
#include "trees/metric_tree.h"
#include "trees/topology/adjacency.h"
#include "trees/values/vertex_values.h"

namespace controlspace {

inline constexpr int levels_of_brick = 2;

/// K_oV's tree, its leaves cut together as bricks.
class BrickOctree : public MetricTree<OctreeNode> {
    using Base = MetricTree<OctreeNode>;

public:
    explicit BrickOctree(const SpaceOptions& options)
        : Base(options, [](const SpaceOptions& of) -> std::unique_ptr<LeafModel<OctreeNode>> {
              return std::make_unique<VertexValues<OctreeNode>>(of);
          }) {
        brick_levels_ = levels_of_brick;
        deepest_ = 16 + levels_of_brick;  // of bricks, as that of leaves in openvdb-tiles
    }

    const Octants& octants() const { return topology_; }
    /// The vertices of its leaves.
    std::span<const Corners> corners() const { return model_->corners(); }
    std::span<const Metric> metrics() const { return model().metrics().field(); }
    /// Of a form that is only read, which is kept as it was loaded.
    const std::optional<SavedBricks>& saved() const { return saved_; }

    void load(const StateReader& state);
    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const BrickOctree>& octree,
                                                  std::optional<Precision> precision);

private:
    std::optional<SavedBricks> saved_;
};

/// The vertices of a brick: those of 4^3 cells, or of 4^2 on a plane, z fastest.
class BrickLattice {
public:
    static constexpr int most = 4;  // cells along an axis
    static constexpr std::size_t most_vertices = std::size_t{most + 1} * (most + 1) * (most + 1);

    explicit BrickLattice(const Box& domain);

    std::size_t vertices() const { return vertices_; }
    const Cell& cells() const { return cells_; }
    std::uint32_t step(std::size_t axis) const { return step_[axis]; }
    /// The largest number below that of the cells along an axis, or 0.
    double below_end(std::size_t axis) const { return below_end_[axis]; }
    /// From the low corner of a cell to the others.
    std::array<std::uint32_t, 8> to_corners() const;
    /// Of a vertex.
    std::uint32_t number(const Cell& at) const;

private:
    Cell cells_;  // along each axis
    std::array<double, 3> below_end_;
    std::array<std::uint32_t, 3> step_;
    std::uint32_t vertices_;
};

/// The bricks of an octree, depth first.
struct Bricks {
    int levels;              // of each below it
    Cuts cuts;               // of the octree
    VoxelBoxes boxes;        // voxels of the size of the finest brick
    std::vector<Ref> parts;  // of the octree
    std::vector<int> level;  // of these

    explicit Bricks(const Octants& tree);

private:
    Bricks(const Octants& tree, const std::vector<std::uint8_t>& below);
    void list(const Octants& tree, const std::vector<std::uint8_t>& below, Ref ref, int at);
};

/// Calls visit(leaf, low, edges) for the leaves of a brick: its low corner and its edges in
/// quarters of the brick's.
template <class Visit>
void for_each_leaf_of_brick(const Octants& tree, Ref ref, const Cell& low, const Cell& edges,
                            const Visit& visit) {
    if (ref.is_leaf()) return visit(LeafIndex{ref.index()}, low, edges);
    const OctreeNode& node = tree.node(ref);
    for (int c = 0; c < node.count(); ++c) {
        const std::size_t slot = node.slot(c);
        Cell child_low = low, child_edges = edges;
        for (std::size_t a = 0; a < 3; ++a) {
            if (!node.cuts(a)) continue;
            child_edges[a] /= 2;
            if ((slot >> a & 1) != 0) child_low[a] += child_edges[a];
        }
        for_each_leaf_of_brick(tree, node.children[slot], child_low, child_edges, visit);
    }
}

/// The metrics of a brick's vertices: those of the octree's, and what is between them where it has
/// fewer leaves than cells.
using BrickMetrics = std::array<Metric, BrickLattice::most_vertices>;
BrickMetrics metrics_of_brick(const BrickOctree& octree, Ref brick, const BrickLattice& lattice);

}  // namespace controlspace
