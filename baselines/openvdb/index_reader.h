// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "baselines/lattice/stencil.h"
#include "baselines/openvdb/dense_tree.h"

namespace controlspace {

/// Reads an index tree of any number of levels, one voxel or many side by side. Dense grids take
/// twice as long by such a descent from node to node as by TreeReader's two steps.
template <class Tree>
class IndexReader : TreeTop<Tree> {
    using Base = TreeTop<Tree>;
    using Base::root_, Base::top_, Base::offset;
    using typename Base::Top;
    using Value = typename Tree::ValueType;

public:
    explicit IndexReader(const Tree& tree) : Base(tree) {}

    [[gnu::always_inline]] const Value& operator()(std::int32_t i, std::int32_t j,
                                                   std::int32_t k) const {
        if (top_ == nullptr) return root_->getValue({i, j, k});
        return value_below(*top_, i, j, k);
    }
    /// The values of many: where these are in nodes is found side by side.
    void read(const CellBatch& batch, std::size_t count,
              std::array<Value, CellBatch::most>& values) const {
        if (top_ == nullptr) {
            for (std::size_t i = 0; i < count; ++i) {
                const Cell cell = batch[i];
                values[i] = root_->getValue({cell[0], cell[1], cell[2]});
            }
            return;
        }
        std::array<std::array<std::uint32_t, CellBatch::most>, Tree::DEPTH - 1> in_nodes;
        find_in_nodes<Top>(batch, count, in_nodes);
        for (std::size_t i = 0; i < count; ++i) values[i] = read_below(*top_, in_nodes, i);
    }

private:
    template <class Node>
    [[gnu::always_inline]] static const Value& value_below(const Node& node, std::int32_t i,
                                                           std::int32_t j, std::int32_t k) {
        if constexpr (Node::LEVEL == 0) {
            return node.buffer().data()[offset(i, j, k)];
        } else {
            const std::uint32_t in_node = Base::template child_of<Node>(i, j, k);
            const auto& part = node.getTable()[in_node];
            if (!node.isChildMaskOn(in_node)) return part.getValue();
            return value_below(*part.getChild(), i, j, k);
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
                in_node[n] = Base::template child_of<Node>(i, j, k);
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
};

}  // namespace controlspace
