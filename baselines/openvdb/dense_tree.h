#pragma once

#include <openvdb/tree/LeafManager.h>
#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "baselines/lattice/stencil.h"
#include "controlspace/geometry/point.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// Trees of OpenVDB that are active and dense over a lattice, voxel (i, j, k) being node (i, j, k).
// Index space starts at 0, since a box around the origin would touch up to eight upper nodes of
// 1.6 MB each. The tree stands without openvdb::Grid: all that Grid adds is a transform, which
// would be a virtual call per point. openvdb::initialize() is not called: it serves files alone.

inline openvdb::Coord voxel(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return {static_cast<openvdb::Int32>(i), static_cast<openvdb::Int32>(j),
            static_cast<openvdb::Int32>(k)};
}

/// Corner `i` of a cell relative to its low one; bit 0 is the high side in x, bit 1 in y, 2 in z.
inline openvdb::Coord corner_step(std::size_t i) {
    const auto bits = static_cast<int>(i);
    return {bits & 1, bits >> 1 & 1, bits >> 2};
}

/// Makes the voxels of all nodes active, with value_of(metric) of each; on all of TBB's threads.
template <class Tree, class ValueOf>
void fill_densely(Tree& tree, const Lattice& lattice, std::span<const Metric> metrics,
                  ValueOf&& value_of) {
    const auto [nx, ny, nz] = lattice.nodes;
    tree.sparseFill({voxel(0, 0, 0), voxel(nx - 1, ny - 1, nz - 1)}, tree.background());
    tree.voxelizeActiveTiles();
    openvdb::tree::LeafManager<Tree> leaves(tree);
    leaves.foreach ([&](typename Tree::LeafNodeType& leaf, std::size_t) {
        for (auto value = leaf.beginValueOn(); value; ++value) {
            const openvdb::Coord c = value.getCoord();
            const NodeIndex node =
                lattice.index(static_cast<std::uint32_t>(c.x()), static_cast<std::uint32_t>(c.y()),
                              static_cast<std::uint32_t>(c.z()));
            leaf.setValueOnly(value.pos(), value_of(metrics[node]));
        }
    });
}

/// Reads the voxels of a tree, one by one or those of many cells side by side (Stencil::sample).
template <class Tree>
class DenseReader {
public:
    explicit DenseReader(const Tree& tree) : nodes_(tree) {}

    const auto& operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        return nodes_.getValue(voxel(i, j, k));
    }
    /// The leaf of the cell's low corner, null where a tile is.
    const auto* prepare(const Cell& cell) const {
        const auto* leaf = nodes_.probeConstLeaf({cell[0], cell[1], cell[2]});
        __builtin_prefetch(leaf);
        return leaf;
    }
    /// Where the values at the cell's corners are, which it prefetches.
    template <std::size_t corners>
    auto find(const Cell& cell, const typename Tree::LeafNodeType* leaf) const {
        constexpr auto side = static_cast<int>(Tree::LeafNodeType::DIM);
        const openvdb::Coord low(cell[0], cell[1], cell[2]);
        const openvdb::Coord within = low & (side - 1);
        const bool fits = corners == 1 || std::max({within.x(), within.y(), within.z()}) + 1 < side;
        std::array<const typename Tree::ValueType*, corners> values;
        if (leaf != nullptr && fits) {
            const auto* first = leaf->buffer().data() + leaf->coordToOffset(low);
            for (std::size_t corner = 0; corner < corners; ++corner) {
                const openvdb::Coord step = corner_step(corner);
                values[corner] = first + (step.x() * side + step.y()) * side + step.z();
            }
        } else {
            for (std::size_t corner = 0; corner < corners; ++corner) {
                values[corner] = &nodes_.getValue(low + corner_step(corner));
            }
        }
        for (const auto* value : values) prefetch(value);
        return values;
    }

private:
    /// For one thread, while no node of the tree is taken away, that the tree need not know of
    /// ("unsafe"): registering one takes a lock and an allocation.
    openvdb::tree::ValueAccessor<const Tree, false> nodes_;
};

/// Bytes of the values of a leaf.
template <class Tree>
constexpr std::size_t leaf_values_bytes = Tree::LeafNodeType::SIZE *
                                          sizeof(typename Tree::ValueType);

/// What a dense tree over so many nodes will allocate.
template <class Tree>
double dense_bytes(const Vector& nodes) {
    using Leaf = typename Tree::LeafNodeType;
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    const auto blocks = [&](double side) { return (nodes.array() / side).ceil().prod(); };
    return blocks(Leaf::DIM) * (sizeof(Leaf) + leaf_values_bytes<Tree>)+blocks(Lower::DIM) *
               sizeof(Lower) +
           blocks(Upper::DIM) * sizeof(Upper) + sizeof(Tree);
}

/// Payload is the leaves' values, those that fill up the outermost leaves included; topology the
/// rest of the tree, as OpenVDB counts it.
template <class Tree>
void add_dense_bytes(const Tree& tree, Footprint& footprint) {
    const std::size_t payload = tree.leafCount() * leaf_values_bytes<Tree>;
    footprint.bytes_payload += payload;
    footprint.bytes_topology += tree.memUsage() - payload;
}

}  // namespace controlspace
