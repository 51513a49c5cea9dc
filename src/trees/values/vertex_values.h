// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/metric/blend.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/detail/state.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/detail/adjacency.h"
#include "controlspace/trees/detail/corners.h"
#include "controlspace/trees/detail/leaf_judge.h"
#include "controlspace/trees/node_metrics.h"
#include "controlspace/trees/topology.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/leaf_vertices.h"
#include "trees/topology/place_index.h"
#include "trees/values/trilinear_cursor.h"

namespace controlspace {

/// A metric at each vertex of the leaves, trilinear between the eight of a leaf (K_V, K_oV).
///
/// A vertex is one control node for all leaves that have a corner there, hanging vertices included.
/// A new vertex of a split gets the interpolated metric; where a control node stands already, it is
/// intersected with that. So a split changes the field only where it makes a finer neighbour's
/// vertex count, and never makes it larger. Or else vertices collect what the leaves around them
/// request, when these have grown (SpaceOptions::vertices_in_turn).
class VertexValues {
public:
    static constexpr int order = 1;
    static constexpr CutBy cut_by = CutBy::edges;
    using trilinear_leaves = VertexValues;

    explicit VertexValues(const SpaceOptions& options);

    template <class Node, class Value>
    void values_in(const Topology<Node>&, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, const NodeView<Metric>& nodes,
                   std::span<Value> out) const {
        trilinear_in_leaves(Field{*this, nodes.metrics}, leaves, x, out);
    }
    void prefetch(LeafIndex leaf) const { __builtin_prefetch(&corners_[leaf]); }
    // Inlined, since GCC 12 leaves out calls of functions that do nothing but prefetch.
    [[gnu::always_inline]] void prefetch_box(LeafIndex leaf) const {
        __builtin_prefetch(&positions_[corners_[leaf].front()]);
        __builtin_prefetch(&positions_[corners_[leaf].back()]);
    }
    [[gnu::always_inline]] Box box(LeafIndex leaf) const {
        return {positions_[corners_[leaf].front()], positions_[corners_[leaf].back()]};
    }
    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new);
    /// Starts anew with the leaves of a tree, which request `metrics`.
    template <class Node>
    void collect(const Topology<Node>& tree, std::span<const Metric> metrics) {
        enter(leaf_vertices(tree), metrics);
    }
    NodeMetrics& metrics() { return metrics_; }
    const NodeMetrics& metrics() const { return metrics_; }
    const Corners& nodes_of(LeafIndex leaf) const { return corners_[leaf]; }
    std::span<const Corners> corners() const { return corners_; }
    const std::vector<Point>& positions() const { return positions_; }

    /// Lengths, where all metrics are isotropic.
    template <class Node>
    std::unique_ptr<Cursor> cursor(const Topology<Node>& tree) const {
        const Field field{*this, metrics_.field()};
        return std::make_unique<TrilinearCursor<Node, Field>>(tree, field);
    }

    template <class Node>
    std::unique_ptr<ControlSpace> pack(const Topology<Node>& tree, Precision precision) const {
        return freeze_vertices(tree, corners_, metrics_.field(), precision);
    }

    static void data(auto& self, auto&& visit) { visit("vertices.of_leaves", self.corners_); }
    /// Checks the vertices, and finds their positions.
    template <class Node>
    void loaded(const Topology<Node>& tree, const StateReader& state) {
        require_sound(state, tree.leaves());
        positions_ = vertex_positions(tree, corners_, metrics_.size());
        tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
            for (int i = 0; i < 8; ++i) {
                const NodeIndex vertex = corners_[leaf][static_cast<std::size_t>(i)];
                state.require(positions_[vertex] == corner(box, i), "vertices.of_leaves",
                              "has a vertex in two places");
            }
        });
    }

    void describe(Footprint& footprint) const;
    void shrink_to_fit();

private:
    /// What trilinear_in_leaves reads.
    struct Field {
        const VertexValues& own;
        std::span<const Metric> of_nodes;

        [[gnu::always_inline]] void prefetch_box(LeafIndex leaf) const { own.prefetch_box(leaf); }
        Box box(LeafIndex leaf) const { return own.box(leaf); }
        AtCorners<Metric> at_corners(LeafIndex leaf) const {
            return {own.corners_[leaf], of_nodes.data()};
        }
    };

    static Metric interpolate(const Corners& corners, const std::array<double, 8>& weights,
                              std::span<const Metric> metrics) {
        return blend_lengths(weights,
                             [&](std::size_t i) -> const Metric& { return metrics[corners[i]]; });
    }
    void enter(LeafVertices vertices, std::span<const Metric> of_leaves);
    NodeIndex vertex_at(const Point& x, const Box& box, const Corners& corners);
    // The index of places waits for the first cut, which needs it.
    void require_sound(const StateReader& state, std::size_t leaves);

    std::vector<Corners> corners_;  // of a leaf, in the order of controlspace::corner
    NodeMetrics metrics_;
    std::vector<Point> positions_;
    PlaceIndex places_;
};

}  // namespace controlspace
