#pragma once

#include <cstddef>
#include <span>
#include <tuple>

#include "controlspace/space/control_space.h"
#include "space/goal_field.h"
#include "space/state.h"
#include "trees/adaptation/leaf_judge.h"
#include "trees/topology/cut.h"
#include "trees/topology/topology.h"
#include "trees/values/node_metrics.h"

namespace controlspace {

// A storage says where the control nodes of a tree are, and how the metric between them is made. It
// is data and these functions; all else is made of them (control_nodes.h, growing_tree.h):
//   metrics()                            NodeMetrics of the control nodes
//   nodes_of(leaf)                       the nodes that govern a leaf: std::array<NodeIndex, n>
//   split(subdivision, leaf, first_new)  the effect of a cut: child 0 keeps the leaf's number, the
//                                        others get the next ones; the field gets nowhere longer
//   value_in(tree, leaf, x)              the metric in a leaf; or, for many at once,
//   values_in(tree, leaves, x, out)
// Where a leaf has several nodes, corners() and positions() say where they stand; otherwise the one
// stands at its centre. Optional:
//   fit(tree, leaves, field, proved)     refits leaves to a field, where that is more than to set
//                                        the nodes to it
//   prefetch(leaf)                       what a value reads first
//   refresh(), refresh(metric)           the metrics have been set; or lowered by one
//   remember_parts(tree)                 makes answers faster until a leaf is split
// Constants:
//   order               of interpolation; with 0, what is asked for in a leaf is its own metric
//   cut_by              how departures from a field show where to cut (leaf_judge.h)
//   follows_neighbours  the field in a leaf varies with what its neighbours hold

/// Number of control nodes of a leaf.
template <class Storage>
inline constexpr std::size_t nodes_per_leaf =
    std::tuple_size_v<std::remove_cvref_t<decltype(std::declval<const Storage&>().nodes_of(0))>>;

/// Compiles for what is a storage, of metrics at control nodes or of sources, and says otherwise
/// what it lacks.
template <class Node, class Storage>
consteval void check_storage() {
    check_cut<Node>();
    static_assert(
        requires {
            { Storage::order } -> std::convertible_to<int>;
        },
        "a storage needs a constant `int order` of interpolation");
    static_assert(
        requires {
            { Storage::cut_by } -> std::convertible_to<CutBy>;
        },
        "a storage needs a constant `CutBy cut_by`");
    static_assert(
        requires {
            { Storage::follows_neighbours } -> std::convertible_to<bool>;
        },
        "a storage needs a constant `bool follows_neighbours`");
    static_assert(
        requires(const SpaceOptions& options) { Storage(options); },
        "a storage needs a constructor from `const SpaceOptions&`");
    static_assert(
        requires(Storage & s, const Subdivision& cut, LeafIndex leaf) { s.split(cut, leaf, leaf); },
        "a storage needs `split(const Subdivision&, LeafIndex leaf, LeafIndex first_new)`");
    static_assert(
        requires(const Storage& s, const Topology<Node>& tree, LeafIndex leaf, const Point& x) {
            { s.value_in(tree, leaf, x) } -> std::convertible_to<Metric>;
        } || requires(const Storage& s, const Topology<Node>& tree,
                      std::span<const LeafIndex> leaves, std::span<const Point> x,
                      std::span<Metric> out) { s.values_in(tree, leaves, x, out); },
        "a storage needs `Metric value_in(tree, leaf, x)` or `values_in(tree, leaves, x, out)`");
    static_assert(
        requires(const Storage& s, Footprint& footprint) { s.describe(footprint); },
        "a storage needs `describe(Footprint&)`, which enters its bytes");
    static_assert(
        requires(const Storage& s, StateWriter& to, Storage& t, const Topology<Node>& tree,
                 const StateReader& from) {
            s.save(to);
            t.load(tree, from);
        },
        "a storage needs `save(StateWriter&)` and `load(tree, const StateReader&)`");
}

/// The same for a storage of metrics at control nodes.
template <class Storage>
consteval void check_node_storage() {
    static_assert(
        requires(Storage & s) {
            { s.metrics() } -> std::same_as<NodeMetrics&>;
        },
        "a storage needs `NodeMetrics& metrics()`");
    static_assert(
        requires(const Storage& s) { s.nodes_of(LeafIndex{}); },
        "a storage needs `nodes_of(LeafIndex)`: the numbers of a leaf's control nodes");
}

}  // namespace controlspace
