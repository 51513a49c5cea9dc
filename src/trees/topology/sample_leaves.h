#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "trees/topology/topology.h"

namespace controlspace {

/// Metrics at `x`: leaves are found for many places side by side, then read. Of `values` it asks
/// prefetch(leaf), if it is worth it, and value_in(tree, leaf, x) or values_in(tree, leaves, x,
/// out) for many.
template <class Node, class Values>
void sample_leaves(const Topology<Node>& tree, const Values& values, std::span<const Point> x,
                   std::span<Metric> out) {
    std::array<LeafIndex, Topology<Node>::most_found> leaves;
    for (std::size_t first = 0; first < x.size(); first += leaves.size()) {
        const auto part = x.subspan(first, std::min(leaves.size(), x.size() - first));
        tree.find(part, leaves);
        if constexpr (requires { values.prefetch(leaves[0]); }) {
            for (std::size_t i = 0; i < part.size(); ++i) values.prefetch(leaves[i]);
        }
        if constexpr (requires { values.values_in(tree, leaves, part, out); }) {
            values.values_in(tree, std::span(leaves).first(part.size()), part,
                             out.subspan(first, part.size()));
        } else {
            for (std::size_t i = 0; i < part.size(); ++i) {
                out[first + i] = values.value_in(tree, leaves[i], part[i]);
            }
        }
    }
}

}  // namespace controlspace
