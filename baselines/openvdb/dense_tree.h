// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/tree/Tree.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

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

/// Makes the voxels of all nodes active, with value_of(node) of each; on all of TBB's threads.
template <class Tree, class ValueOf>
void fill_densely(Tree& tree, const Lattice& lattice, ValueOf&& value_of) {
    const auto [nx, ny, nz] = lattice.nodes;
    tree.sparseFill({voxel(0, 0, 0), voxel(nx - 1, ny - 1, nz - 1)}, tree.background());
    tree.voxelizeActiveTiles();
    // In place of a LeafManager, which takes long to compile.
    std::vector<typename Tree::LeafNodeType*> leaves;
    tree.getNodes(leaves);
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t n) {
        typename Tree::LeafNodeType& leaf = *leaves[n];
        for (auto value = leaf.beginValueOn(); value; ++value) {
            const openvdb::Coord c = value.getCoord();
            const NodeIndex node =
                lattice.index(static_cast<std::uint32_t>(c.x()), static_cast<std::uint32_t>(c.y()),
                              static_cast<std::uint32_t>(c.z()));
            leaf.setValueOnly(value.pos(), value_of(node));
        }
    });
}

/// What readers descend from: the only node below the root itself, with whole numbers in place of a
/// Coord. At random places that is faster than a ValueAccessor (bench/results/overhead), with
/// nothing to register or to keep for each thread. Where there are several such nodes, beyond 4096
/// voxels along an axis of the standard tree, they ask the root.
template <class Tree>
class TreeTop {
protected:
    using Leaf = typename Tree::LeafNodeType;
    using Top = typename Tree::RootNodeType::ChildNodeType;

    explicit TreeTop(const Tree& tree) : root_(&tree.root()) {
        if (root_->getTableSize() != 1) return;
        const auto only = root_->cbeginChildOn();
        if (only && only->origin() == openvdb::Coord()) top_ = &*only;
    }

    template <class Node>
    static std::uint32_t child_of(std::int32_t i, std::int32_t j, std::int32_t k) {
        const auto part = [](std::int32_t c) {
            return static_cast<std::uint32_t>(c) >> Node::ChildNodeType::TOTAL &
                   ((1U << Node::LOG2DIM) - 1);
        };
        return (part(i) << Node::LOG2DIM | part(j)) << Node::LOG2DIM | part(k);
    }
    static std::int32_t offset(std::int32_t i, std::int32_t j, std::int32_t k) {
        constexpr auto side = static_cast<std::int32_t>(Leaf::DIM);
        return ((i & (side - 1)) * side + (j & (side - 1))) * side + (k & (side - 1));
    }

    const typename Tree::RootNodeType* root_;
    const Top* top_ = nullptr;
};

/// Reads the voxels of a tree of three levels, one by one or those of many cells side by side
/// (Stencil::sample).
template <class Tree>
class TreeReader : TreeTop<Tree> {
    using Base = TreeTop<Tree>;
    using Base::root_, Base::top_, Base::offset;
    using typename Base::Leaf;
    using Value = typename Tree::ValueType;
    using Upper = typename Base::Top;
    using Lower = typename Upper::ChildNodeType;

public:
    explicit TreeReader(const Tree& tree) : Base(tree) {}

    const Value& operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        return value(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j),
                     static_cast<std::int32_t>(k));
    }
    /// The leaf of the cell's low corner, null where a tile is.
    const Leaf* prepare(const Cell& cell) const {
        const Leaf* leaf = descend(cell[0], cell[1], cell[2]).leaf;
        __builtin_prefetch(leaf);
        return leaf;
    }
    /// Where the values at the cell's corners are, which it prefetches.
    template <std::size_t corners, bool ahead = true>
    auto find(const Cell& cell, const Leaf* leaf) const {
        constexpr auto side = static_cast<std::int32_t>(Leaf::DIM);
        const auto within = [&](std::size_t a) { return cell[a] & (side - 1); };
        const bool fits = corners == 1 || std::max({within(0), within(1), within(2)}) + 1 < side;
        std::array<const Value*, corners> values;
        if (leaf != nullptr && fits) {
            const Value* first = leaf->buffer().data() + offset(cell[0], cell[1], cell[2]);
            for (std::size_t corner = 0; corner < corners; ++corner) {
                const openvdb::Coord step = corner_step(corner);
                values[corner] = first + (step.x() * side + step.y()) * side + step.z();
            }
        } else {
            for (std::size_t corner = 0; corner < corners; ++corner) {
                const openvdb::Coord step = corner_step(corner);
                values[corner] = &value(cell[0] + step.x(), cell[1] + step.y(), cell[2] + step.z());
            }
        }
        if constexpr (ahead) {
            for (const Value* value : values) prefetch(value);
        }
        return values;
    }

private:
    /// A leaf, or the value of the tile in its place.
    struct Found {
        const Leaf* leaf;
        const Value* tile;
    };

    [[gnu::always_inline]] Found descend(std::int32_t i, std::int32_t j, std::int32_t k) const {
        if (top_ == nullptr) {
            const openvdb::Coord at(i, j, k);
            const Leaf* leaf = root_->probeConstLeaf(at);
            return {leaf, leaf == nullptr ? &root_->getValue(at) : nullptr};
        }
        const std::uint32_t in_top = Base::template child_of<Upper>(i, j, k);
        const auto& lower = top_->getTable()[in_top];
        if (!top_->isChildMaskOn(in_top)) return {nullptr, &lower.getValue()};
        const std::uint32_t in_lower = Base::template child_of<Lower>(i, j, k);
        const auto& leaf = lower.getChild()->getTable()[in_lower];
        if (!lower.getChild()->isChildMaskOn(in_lower)) return {nullptr, &leaf.getValue()};
        return {leaf.getChild(), nullptr};
    }
    const Value& value(std::int32_t i, std::int32_t j, std::int32_t k) const {
        const Found found = descend(i, j, k);
        return found.leaf == nullptr ? *found.tile : found.leaf->buffer().data()[offset(i, j, k)];
    }
};

/// Bytes of the values of a leaf.
template <class Tree>
constexpr std::size_t leaf_values_bytes = Tree::LeafNodeType::SIZE *
                                          sizeof(typename Tree::ValueType);

/// Bytes of nodes of this type and below, without the values of leaves.
template <class Node, class Count>
double bytes_of_nodes_below(const Count& count) {
    const double own = count(Node::DIM) * sizeof(Node);
    if constexpr (Node::LEVEL == 0) {
        return own;
    } else {
        return own + bytes_of_nodes_below<typename Node::ChildNodeType>(count);
    }
}

/// What a tree will allocate that has count(side) nodes of `side` voxels along each axis.
template <class Tree, class Count>
double bytes_of_nodes(const Count& count) {
    return count(Tree::LeafNodeType::DIM) * leaf_values_bytes<Tree> +
           bytes_of_nodes_below<typename Tree::RootNodeType::ChildNodeType>(count) + sizeof(Tree);
}

/// The same of a dense tree over so many nodes of a lattice.
template <class Tree>
double dense_bytes(const Vector& nodes) {
    return bytes_of_nodes<Tree>([&](double side) { return (nodes.array() / side).ceil().prod(); });
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
