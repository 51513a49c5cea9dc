// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/metric/stored_metrics.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/trees/node_metrics.h"
#include "space/plain_cursor.h"
#include "space/saved.h"
#include "trees/sample_leaves.h"
#include "trees/topology/leaf_graph.h"
#include "trees/topology/topology_state.h"

namespace controlspace {

// Compact forms of trees, which can only be read (BuildOptions::precision): inner nodes and leaves
// lie depth first, and only what reading needs is kept: of metrics that are all isotropic, their
// lengths. With doubles they answer as the tree does, to the bit. They are saved as the tree is,
// with nodes and leaves in their order.

/// The metrics of a compact form for a file: lengths in 16 bits as floats, which take less room
/// there and are rounded to the same codes again.
template <class M>
NodeMetrics saved_metrics(std::vector<Metric> metrics) {
    if constexpr (std::is_same_v<M, StoredLength<std::uint16_t>>) {
        for (Metric& m : metrics) m = StoredLength<float>(m);
    }
    return NodeMetrics(std::move(metrics));
}

/// A tree whose leaves, numbered depth first, hold `Values`, which provide
///   are_lengths                          whether they answer lengths
///   prefetch(leaf), values_in(tree, leaves, x, out)
///   cursor(tree)                         for lengths; null where it would remember nothing
///   control_nodes(tree, neighbourhood), describe(footprint), save(tree, state)
template <class Node, class Values>
class PackedTree final : public ControlSpace, public HasControlNodes, public Saved {
public:
    PackedTree(Topology<Node> topology, Values values)
        : topology_(std::move(topology)), values_(std::move(values)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        sample_values(x, out);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (Values::are_lengths) {
            sample_values(x, out);
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override { return at<Metric>(x); }
    double length_at(const Point& x) const override {
        if constexpr (Values::are_lengths) {
            return at<double>(x);
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        if constexpr (Values::are_lengths) {
            if (auto cursor = values_.cursor(topology_)) return cursor;
        }
        return std::make_unique<PlainCursor<PackedTree>>(*this);
    }
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        return values_.control_nodes(topology_, neighbourhood);
    }
    Box domain() const override { return topology_.domain(); }
    std::optional<Box> cell_at(const Point& x) const override { return topology_.locate(x).box; }
    Footprint footprint() const override {
        Footprint footprint;
        topology_.describe(footprint);
        values_.describe(footprint);
        return footprint;
    }
    void save(StateWriter& state) const override {
        controlspace::save(topology_, state);
        values_.save(topology_, state);
    }

private:
    template <class Value>
    void sample_values(std::span<const Point> x, std::span<Value> out) const {
        sample_leaves(topology_, x, out,
                      [&](std::span<const LeafIndex> leaves, std::span<const Point> part,
                          std::span<Value> values) {
                          for (const LeafIndex leaf : leaves) values_.prefetch(leaf);
                          values_.values_in(topology_, leaves, part, values);
                      });
    }
    template <class Value>
    Value at(const Point& x) const {
        const LeafIndex leaf = topology_.find(x);
        Value value;
        values_.values_in(topology_, std::span(&leaf, 1), std::span(&x, 1), std::span(&value, 1));
        return value;
    }

    Topology<Node> topology_;
    Values values_;
};

/// Metrics of leaves, one each, stored as `M`, which are those of the whole leaf.
template <class M, bool answers_lengths = is_stored_length<M>>
class PackedLeaves {
public:
    static constexpr bool are_lengths = answers_lengths;

    explicit PackedLeaves(StoredMetrics<M> metrics) : metrics_(std::move(metrics)) {}

    void prefetch(LeafIndex) const {}
    template <class Node, class Value>
    void values_in(const Topology<Node>&, std::span<const LeafIndex> leaves, std::span<const Point>,
                   std::span<Value> out) const {
        const auto items = metrics_.items();
        const auto packing = metrics_.packing();
        for (std::size_t i = 0; i < out.size(); ++i) {
            if constexpr (std::is_same_v<Value, double>) {
                out[i] = length_of(packing(items[leaves[i]]));
            } else {
                out[i] = packing(items[leaves[i]]);
            }
        }
    }
    template <class Node>
    std::unique_ptr<Cursor> cursor(const Topology<Node>&) const {
        return nullptr;
    }
    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const {
        return {leaf_graph(tree, neighbourhood).graph, metrics_.metrics()};
    }
    void describe(Footprint& footprint) const {
        footprint.control_nodes = metrics_.size();
        footprint.bytes_payload += metrics_.bytes();
    }
    template <class Node>
    void save(const Topology<Node>&, StateWriter& state) const {
        NodeMetrics::exchange(saved_metrics<M>(metrics_.metrics()), state);
    }

protected:
    StoredMetrics<M> metrics_;
};

}  // namespace controlspace
