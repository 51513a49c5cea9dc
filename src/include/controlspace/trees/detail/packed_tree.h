// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/metric/stored_metrics.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/detail/plain_cursor.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/detail/leaf_graph.h"
#include "controlspace/trees/detail/sample_leaves.h"
#include "controlspace/trees/detail/storage_state.h"
#include "controlspace/trees/detail/topology_state.h"

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

/// What the leaves of a compact form hold, of any storage with one node a leaf: its data, and the
/// metrics stored as `M`.
template <class Storage, class M>
class PackedValues {
public:
    static constexpr bool are_lengths = is_stored_length<M>;

    /// Of a storage made with `options`; `former` are the former numbers of the leaves.
    PackedValues(const Storage& storage, const SpaceOptions& options,
                 std::span<const LeafIndex> former)
        : storage_(without_metrics(storage, options)), metrics_(storage.metrics().field(), former) {
        for_each_array(storage_, [&](std::string_view, auto& array) {
            auto ordered = std::remove_cvref_t<decltype(array)>();
            ordered.reserve(former.size());
            for (const LeafIndex leaf : former) ordered.push_back(array[leaf]);
            array = std::move(ordered);
        });
    }

    void prefetch(LeafIndex leaf) const { field().prefetch(leaf); }
    template <class Node, class Value>
    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Value> out) const {
        field().values_in(tree, leaves, x, out);
    }
    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const {
        return {leaf_graph(tree, neighbourhood).graph, metrics_.metrics()};
    }
    void describe(Footprint& footprint) const {
        describe_storage(storage_, footprint);
        footprint.control_nodes = metrics_.size();
        footprint.bytes_payload += metrics_.bytes();
    }
    template <class Node>
    void save(const Topology<Node>&, StateWriter& state) const {
        save_storage(storage_, saved_metrics<M>(metrics_.metrics()), state);
    }

private:
    static Storage without_metrics(const Storage& storage, const SpaceOptions& options) {
        // Metrics take most of the memory: a copy would hold them twice.
        Storage copy = HasData<Storage> ? storage : Storage(options);
        copy.metrics() = NodeMetrics(0, Metric());
        return copy;
    }
    NodeField<Storage, M> field() const {
        return {storage_, {metrics_.items(), false, metrics_.packing()}};
    }

    Storage storage_;  // without metrics
    StoredMetrics<M> metrics_;
};

/// A tree whose leaves, numbered depth first, hold `Values`: see PackedValues.
template <class Node, class Values>
class PackedTree final : public ControlSpace, public HasControlNodes, public Saved {
public:
    PackedTree(Topology<Node> topology, Values values)
        : topology_(std::move(topology)), values_(std::move(values)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        sample_leaves(topology_, values_, x, out);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (Values::are_lengths) {
            sample_leaves(topology_, values_, x, out);
        } else {
            ControlSpace::sample_lengths(x, out);
        }
    }
    Metric metric_at(const Point& x) const override { return value_at(topology_, values_, x); }
    double length_at(const Point& x) const override {
        if constexpr (Values::are_lengths) {
            return value_at<double>(topology_, values_, x);
        } else {
            return ControlSpace::length_at(x);
        }
    }
    std::unique_ptr<Cursor> cursor() const override {
        if constexpr (Values::are_lengths && requires { values_.cursor(topology_); }) {
            return values_.cursor(topology_);
        } else {
            return std::make_unique<PlainCursor<PackedTree>>(*this);
        }
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
    Topology<Node> topology_;
    Values values_;
};

/// Whether a storage derives members from its metrics and data, for the leaves as they are
/// numbered.
template <class Storage, class Node>
concept HasDerivedData = requires(Storage& s, const Topology<Node>& tree) {
    s.prepare(tree);
}
|| requires(Storage& s, const Topology<Node>& tree, const StateReader& r) { s.loaded(tree, r); };

/// The compact form of a tree.
template <class Node, class Storage>
std::unique_ptr<ControlSpace> pack_tree(const Topology<Node>& tree, const Storage& storage,
                                        const SpaceOptions& options, Precision precision) {
    if constexpr (requires { storage.pack(tree, precision); }) {
        return storage.pack(tree, precision);
    } else {
        static_assert(nodes_per_leaf<Storage> == 1 && !HasDerivedData<Storage, Node>,
                      "a storage with eight nodes a leaf, `loaded` or `prepare` needs `pack(tree, "
                      "precision)`");
        std::vector<LeafIndex> former;
        Topology<Node> ordered = tree.depth_first(former);
        return with_stored<AnswersLengths<Storage, Node>>(
            precision, storage.metrics().field(),
            [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
                using Packed = PackedValues<Storage, M>;
                return std::make_unique<PackedTree<Node, Packed>>(std::move(ordered),
                                                                  Packed(storage, options, former));
            });
    }
}

}  // namespace controlspace
