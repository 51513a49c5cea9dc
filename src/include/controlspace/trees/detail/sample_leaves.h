// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>

#include "controlspace/metric/stored_metric.h"
#include "controlspace/trees/storage.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// The field that a storage makes of some metrics of its nodes: values_in(tree, leaves, x, out).
template <class Storage, class M>
struct NodeField {
    const Storage& storage;
    NodeView<M> nodes;

    [[gnu::always_inline]] void prefetch(LeafIndex leaf) const {
        if constexpr (requires { storage.prefetch(leaf); }) storage.prefetch(leaf);
    }
    template <class Node, class Value>
    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Value> out) const {
        if constexpr (requires { storage.values_in(tree, leaves, x, nodes, out); }) {
            storage.values_in(tree, leaves, x, nodes, out);
        } else {
            for (std::size_t i = 0; i < x.size(); ++i) {
                if constexpr (std::is_same_v<Value, double>) {
                    out[i] = length_of(storage.value_in(tree, leaves[i], x[i], nodes));
                } else {
                    out[i] = storage.value_in(tree, leaves[i], x[i], nodes);
                }
            }
        }
    }
};

/// The field of a storage, whether it holds metrics of nodes or sources.
template <class Storage>
decltype(auto) field_of(const Storage& storage) {
    if constexpr (requires { storage.metrics(); }) {
        return NodeField<Storage, Metric>{storage, storage.metrics().values()};
    } else {
        return (storage);
    }
}
/// What the sources alone request.
template <class Storage>
NodeField<Storage, Metric> requested_of(const Storage& storage) {
    return {storage, storage.metrics().requested_values()};
}

/// The metric at one point, or the length where all are known to be isotropic, of a leaf if that is
/// known.
template <class Value = Metric, class Node, class Field>
Value value_in(const Topology<Node>& tree, const Field& field, LeafIndex leaf, const Point& x) {
    Value value;
    field.values_in(tree, {&leaf, 1}, {&x, 1}, std::span(&value, 1));
    return value;
}
template <class Value = Metric, class Node, class Field>
Value value_at(const Topology<Node>& tree, const Field& field, const Point& x) {
    return value_in<Value>(tree, field, tree.find(x), x);
}

/// The same at many points: leaves are found side by side, then read.
template <class Node, class Field, class Value>
void sample_leaves(const Topology<Node>& tree, const Field& field, std::span<const Point> x,
                   std::span<Value> out) {
    std::array<LeafIndex, Topology<Node>::most_found> leaves;
    for (std::size_t first = 0; first < x.size(); first += leaves.size()) {
        const auto part = x.subspan(first, std::min(leaves.size(), x.size() - first));
        tree.find(part, leaves);
        if constexpr (requires { field.prefetch(leaves[0]); }) {
            for (std::size_t i = 0; i < part.size(); ++i) field.prefetch(leaves[i]);
        }
        field.values_in(tree, std::span(leaves).first(part.size()), part,
                        out.subspan(first, part.size()));
    }
}

}  // namespace controlspace
