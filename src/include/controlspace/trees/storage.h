// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/cut.h"
#include "controlspace/trees/node_metrics.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

// A storage defines where the control nodes of a tree are, and how the metric between them is
// interpolated. It is data and four functions. Insertion (paper §3.1), gradation (§3.2),
// adaptation, compact forms, files and footprints are made of them (tree_row.h).
//
//   metrics()                            NodeMetrics of the control nodes
//   nodes_of(leaf)                       numbers of the control nodes of a leaf: std::array of one,
//                                        which is the leaf's own number, or of eight
//   split(subdivision, leaf, first_new)  the effect of a cut: child 0 keeps the leaf's number,
//                                        children 1, 2, ... get first_new, first_new + 1, ...; the
//                                        field gets nowhere longer
//   value_in(tree, leaf, x, nodes)       the metric at x, made of `nodes` (NodeView). The leaf
//                                        holds x, or the point of the domain that is nearest to x,
//                                        whose metric it is then. Or, for many at once,
//   values_in(tree, leaves, x, nodes, out)
//                                        Where value_in returns what `nodes` hold, or values_in
//                                        writes to numbers too, lengths are asked for without
//                                        tensors (AnswersLengths): name their types of results,
//                                        `auto` is compiled for lengths too.
//
// and a constructor from SpaceOptions, for a tree of one leaf with largest_metric(options). A
// single node of a leaf stands at its centre; for eight, corners() and positions() give those of
// all leaves and all nodes. Constants:
//
//   order   of interpolation: 0 constant in a leaf, 1 linear, 2 quadratic
//   cut_by  how the error of the interpolation depends on the place in a leaf (CutBy)
//   follows_neighbours  true where the value in a leaf depends on its neighbours' metrics;
//                       otherwise it may be left out
//
// and, where the metric in a leaf is just that of its node, and insertion and adaptation need not
// go through the functions below, `using constant_leaves = ` the storage itself (LeafMetrics).
//
// and, where a leaf's isotropic lengths are trilinear between those of its eight nodes, which are
// its corners, so that adaptation can show that they follow a field everywhere,
// `using trilinear_leaves = ` the storage itself (K_V, K_oV).
//
// Members beside the NodeMetrics are listed in
//
//   static void data(auto& self, auto&& visit) { visit("mine.slopes", self.slopes_); ... }
//
// with a name in files each: arrays with an entry for each leaf (std::vector of double, Point, Box,
// Metric, std::uint32_t or std::array of one of them), and numbers. Optional functions:
//
//   fit(leaf, field)       sets the node and the data of a leaf (LeafBox) to a field
//                          (ControlSpace), for adaptation; called for several leaves at the same
//                          time. Without it the nodes are set to the field.
//   lower(place, metric)   intersects the metrics of a leaf with a source's, where
//                          NodeMetrics::lower does not do: at the source, the field must not be
//                          longer after it
//   assigned()             metrics were set from outside
//   graded(ratio)          all metrics were graded with this ratio, or fitted to a field of it
//   prefetch(leaf)         prefetches what value_in reads first
//   ceiling(leaf, x)       upper bound of the requested isotropic length at x, now and after all
//                          later insertions; infinity where there is none
//   collect(tree, metrics) starts anew with the leaves of a tree, each of which requests a metric;
//                          insertion then cuts leaves as those of LeafMetrics, on all threads
//                          (SpaceOptions::vertices_in_turn)
//   cursor(tree)           lengths for one caller (Cursor), beside trilinear_leaves
//   prepare(tree)          makes queries faster until a leaf is cut; they may come without it
//   pack(tree, precision)  the compact form, in which leaves have other numbers. Required for eight
//                          nodes a leaf, and with `loaded` or `prepare`.
//   loaded(tree, state)    checks what was loaded, and makes what is not in files. Required where
//                          an array does not have one entry for each leaf.
//   describe(footprint), shrink_to_fit()
//                          where not all memory is in metrics() and data()

/// Number of control nodes of a leaf.
template <class Storage>
inline constexpr std::size_t nodes_per_leaf =
    std::tuple_size_v<std::remove_cvref_t<decltype(std::declval<const Storage&>().nodes_of(0))>>;

/// Whether control nodes are the vertices of the leaves, which share them.
template <class Storage>
inline constexpr bool has_vertices = nodes_per_leaf<Storage> == 8;

/// Whether a storage lists data beside its metrics.
template <class Storage>
concept HasData = requires(Storage& s) {
    Storage::data(s, [](std::string_view, auto&) {});
};

/// Whether the metric in a leaf is just that of its node. Not inherited: a storage made of another
/// may say more about its leaves.
template <class Storage>
concept HasConstantLeaves = std::is_same_v<typename Storage::constant_leaves, Storage>;

/// Whether lengths in a leaf are trilinear between its nodes'. Not inherited either.
template <class Storage>
concept HasTrilinearLeaves = std::is_same_v<typename Storage::trilinear_leaves, Storage>;

/// Whether a storage answers lengths where all its metrics are isotropic, of StoredLengths too:
/// value_in returns what `nodes` hold, or values_in writes to numbers.
template <class Storage, class Node>
concept AnswersLengths = requires(const Storage& s, const Topology<Node>& tree,
                                  std::span<const LeafIndex> leaves, std::span<const Point> x,
                                  const NodeView<Metric>& nodes, std::span<double> out) {
    s.values_in(tree, leaves, x, nodes, out);
}
|| requires(const Storage& s, const Topology<Node>& tree, const Point& x,
            const NodeView<StoredLength<double>>& nodes) {
    { s.value_in(tree, 0, x, nodes) } -> std::same_as<StoredLength<double>>;
};

template <class Storage>
consteval bool follows_neighbours() {
    if constexpr (requires { Storage::follows_neighbours; }) return Storage::follows_neighbours;
    return false;
}

/// Compiles for a storage, of metrics or of sources; otherwise says what is missing.
template <class Storage>
consteval void check_storage() {
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
        requires(const SpaceOptions& options) { Storage(options); },
        "a storage needs a constructor from `const SpaceOptions&`");
    static_assert(
        requires(Storage & s, const Subdivision& cut, LeafIndex leaf) { s.split(cut, leaf, leaf); },
        "a storage needs `split(const Subdivision&, LeafIndex leaf, LeafIndex first_new)`");
}

/// The same for a storage of metrics at control nodes of a tree with inner nodes `Node`.
template <class Node, class Storage>
consteval void check_node_storage() {
    check_storage<Storage>();
    static_assert(
        requires(Storage & s, const Storage& constant) {
            { s.metrics() } -> std::same_as<NodeMetrics&>;
            { constant.metrics() } -> std::same_as<const NodeMetrics&>;
        },
        "a storage needs `NodeMetrics& metrics()`, and the same for a constant one");
    static_assert(
        requires(const Storage& s) { s.nodes_of(LeafIndex{}); },
        "a storage needs `nodes_of(LeafIndex)`: the numbers of a leaf's control nodes");
    static_assert(
        requires(const Storage& s, const Topology<Node>& tree, LeafIndex leaf, const Point& x,
                 NodeView<Metric> nodes) {
            { s.value_in(tree, leaf, x, nodes) } -> std::convertible_to<Metric>;
        } || requires(const Storage& s, const Topology<Node>& tree,
                      std::span<const LeafIndex> leaves, std::span<const Point> x,
                      NodeView<Metric> nodes,
                      std::span<Metric> out) { s.values_in(tree, leaves, x, nodes, out); },
        "a storage needs `Metric value_in(tree, leaf, x, nodes)` or `values_in(tree, leaves, x, "
        "nodes, out)`");
    static_assert(HasData<Storage> || sizeof(Storage) == sizeof(NodeMetrics),
                  "a storage with members beside its NodeMetrics needs `static void data(auto& "
                  "self, auto&& visit)`, which lists them");
    if constexpr (requires(const Storage& s) { s.nodes_of(LeafIndex{}); }) {
        static_assert(nodes_per_leaf<Storage> == 1 || nodes_per_leaf<Storage> == 8,
                      "a leaf has one control node, or eight");
        static_assert(
            nodes_per_leaf<Storage> == 1 ||
                requires(const Storage& s) {
                    s.corners();
                    s.positions();
                },
            "a storage with eight nodes a leaf needs `corners()` and `positions()`");
    }
}

}  // namespace controlspace
