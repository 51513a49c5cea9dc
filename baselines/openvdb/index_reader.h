// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/tree/Tree.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "baselines/lattice/stencil.h"

namespace controlspace {

/// Reads an index tree of any number of levels, one voxel or many side by side, as TreeReader does,
/// which knows trees of three alone: dense grids are read twice as fast by that.
template <class Tree>
class IndexReader {
    using Value = typename Tree::ValueType;
    using Leaf = typename Tree::LeafNodeType;
    using Top = typename Tree::RootNodeType::ChildNodeType;

public:
    explicit IndexReader(const Tree& tree) : root_(&tree.root()) {
        if (root_->getTableSize() != 1) return;
        const auto only = root_->cbeginChildOn();
        if (only && only->origin() == openvdb::Coord()) top_ = &*only;
    }

    [[gnu::always_inline]] const Value& operator()(std::uint32_t i, std::uint32_t j,
                                                   std::uint32_t k) const {
        const auto x = static_cast<std::int32_t>(i), y = static_cast<std::int32_t>(j),
                   z = static_cast<std::int32_t>(k);
        const Found found = descend(x, y, z);
        return found.leaf == nullptr ? *found.tile : found.leaf->buffer().data()[offset(x, y, z)];
    }
    /// The values of many, without their corners: where these are in nodes is found side by side.
    void read(const CellBatch& batch, std::size_t count,
              std::array<Value, CellBatch::most>& values) const {
        if (top_ == nullptr) {
            for (std::size_t i = 0; i < count; ++i) {
                const Cell cell = batch[i];
                values[i] = value(cell[0], cell[1], cell[2]);
            }
            return;
        }
        std::array<std::array<std::uint32_t, CellBatch::most>, Tree::DEPTH - 1> in_nodes;
        find_in_nodes<Top>(batch, count, in_nodes);
        for (std::size_t i = 0; i < count; ++i) values[i] = read_below(*top_, in_nodes, i);
    }

private:
    /// A leaf, or the value of the tile in its place.
    struct Found {
        const Leaf* leaf;
        const Value* tile;
    };

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
    [[gnu::always_inline]] Found descend(std::int32_t i, std::int32_t j, std::int32_t k) const {
        if (top_ == nullptr) {
            const openvdb::Coord at(i, j, k);
            const Leaf* leaf = root_->probeConstLeaf(at);
            return {leaf, leaf == nullptr ? &root_->getValue(at) : nullptr};
        }
        return descend(*top_, i, j, k);
    }
    template <class Node>
    [[gnu::always_inline]] static Found descend(const Node& node, std::int32_t i, std::int32_t j,
                                                std::int32_t k) {
        if constexpr (std::is_same_v<Node, Leaf>) {
            return {&node, nullptr};
        } else {
            const std::uint32_t in_node = child_of<Node>(i, j, k);
            const auto& part = node.getTable()[in_node];
            if (!node.isChildMaskOn(in_node)) return {nullptr, &part.getValue()};
            return descend(*part.getChild(), i, j, k);
        }
    }
    // Of the nodes of this type and below, which are those of these levels.
    template <class Node>
    static void find_in_nodes(const CellBatch& batch, std::size_t count, auto& in_nodes) {
        auto& in_node = in_nodes[Node::LEVEL];
        for (std::size_t n = 0; n < count; ++n) {
            const std::int32_t i = batch.cell[0][n], j = batch.cell[1][n], k = batch.cell[2][n];
            if constexpr (Node::LEVEL == 0) {
                in_node[n] = static_cast<std::uint32_t>(offset(i, j, k));
            } else {
                in_node[n] = child_of<Node>(i, j, k);
            }
        }
        if constexpr (Node::LEVEL > 0) {
            find_in_nodes<typename Node::ChildNodeType>(batch, count, in_nodes);
        }
    }
    template <class Node>
    [[gnu::always_inline]] static const Value& read_below(const Node& node, const auto& in_nodes,
                                                          std::size_t n) {
        const std::uint32_t in_node = in_nodes[Node::LEVEL][n];
        if constexpr (Node::LEVEL == 0) {
            return node.buffer().data()[in_node];
        } else {
            const auto& part = node.getTable()[in_node];
            if (!node.isChildMaskOn(in_node)) return part.getValue();
            return read_below(*part.getChild(), in_nodes, n);
        }
    }
    const Value& value(std::int32_t i, std::int32_t j, std::int32_t k) const {
        const Found found = descend(i, j, k);
        return found.leaf == nullptr ? *found.tile : found.leaf->buffer().data()[offset(i, j, k)];
    }

    const typename Tree::RootNodeType* root_;
    const Top* top_ = nullptr;
};

}  // namespace controlspace
