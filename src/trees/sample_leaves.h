// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "controlspace/trees/leaf_model.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Calls read(leaves, part of x, part of out) for some places at a time: their leaves are found
/// side by side, then read.
template <class Node, class Value, class Read>
[[gnu::always_inline]] inline void sample_leaves(const Topology<Node>& tree,
                                                 std::span<const Point> x, std::span<Value> out,
                                                 const Read& read) {
    std::array<LeafIndex, Topology<Node>::most_found> leaves;
    for (std::size_t first = 0; first < x.size(); first += leaves.size()) {
        const auto part = x.subspan(first, std::min(leaves.size(), x.size() - first));
        tree.find(part, leaves);
        read(std::span<const LeafIndex>(leaves).first(part.size()), part,
             out.subspan(first, part.size()));
    }
}

/// The metric at one point, of a leaf if that is known.
template <class Node>
Metric value_in(const Topology<Node>& tree, const LeafModel<Node>& model, LeafIndex leaf,
                const Point& x) {
    Metric value;
    model.values(tree, {&leaf, 1}, {&x, 1}, {&value, 1});
    return value;
}
template <class Node>
Metric value_at(const Topology<Node>& tree, const LeafModel<Node>& model, const Point& x) {
    return value_in(tree, model, tree.find(x), x);
}

}  // namespace controlspace
