// SPDX-License-Identifier: Apache-2.0
#include "trees/values/vertex_values.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"
#include "geometry/threads.h"
#include "space/goal_field.h"
#include "space/state.h"
#include "trees/adaptation/cell_judge.h"
#include "trees/make_room.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/adjacency.h"
#include "trees/topology/cut_lattice.h"
#include "trees/topology/leaf_vertices.h"
#include "trees/values/trilinear_cursor.h"

namespace controlspace {

/// What trilinear_in_leaves reads.
template <class Node>
struct VertexValues<Node>::Field {
    const VertexValues& own;
    std::span<const Metric> of_nodes;

    // Inlined, since GCC 12 leaves out calls of functions that do nothing but prefetch.
    [[gnu::always_inline]] void prefetch_box(LeafIndex leaf) const {
        __builtin_prefetch(&own.positions_[own.corners_[leaf].front()]);
        __builtin_prefetch(&own.positions_[own.corners_[leaf].back()]);
    }
    [[gnu::always_inline]] Box box(LeafIndex leaf) const {
        return {own.positions_[own.corners_[leaf].front()],
                own.positions_[own.corners_[leaf].back()]};
    }
    AtCorners<Metric> at_corners(LeafIndex leaf) const {
        return {own.corners_[leaf], of_nodes.data()};
    }
};

template <class Node>
VertexValues<Node>::VertexValues(const SpaceOptions& options)
    : LeafModel<Node>(model_traits, NodeMetrics(0, Metric())), corners_(1) {
    for (int i = 0; i < 8; ++i) {
        const Point x = corner(options.domain, i);
        const auto next = static_cast<NodeIndex>(positions_.size());
        const NodeIndex node = places_.find_or_enter(x, next, positions_);
        if (node == next) positions_.push_back(x);  // those of a flat domain coincide
        corners_[0][static_cast<std::size_t>(i)] = node;
    }
    this->metrics_ = NodeMetrics(positions_.size(), largest_metric(options));
}

template <class Node>
void VertexValues<Node>::prefetch(std::span<const LeafIndex> leaves) const {
    if (leaves.size() == 1) return;
    for (const LeafIndex leaf : leaves) __builtin_prefetch(&corners_[leaf]);
}

template <class Node>
void VertexValues<Node>::values(const Topology<Node>&, std::span<const LeafIndex> leaves,
                                std::span<const Point> x, std::span<Metric> out) const {
    prefetch(leaves);
    trilinear_in_leaves(Field{*this, this->metrics_.field()}, leaves, x, out);
}

template <class Node>
void VertexValues<Node>::lengths(const Topology<Node>&, std::span<const LeafIndex> leaves,
                                 std::span<const Point> x, std::span<double> out) const {
    prefetch(leaves);
    trilinear_in_leaves(Field{*this, this->metrics_.field()}, leaves, x, out);
}

template <class Node>
std::unique_ptr<Cursor> VertexValues<Node>::cursor(const Topology<Node>& tree) const {
    const Field field{*this, this->metrics_.field()};
    return std::make_unique<TrilinearCursor<Node, Field>>(tree, field);
}

template <class Node>
std::unique_ptr<ControlSpace> VertexValues<Node>::compact(const Topology<Node>& tree,
                                                          Precision precision) const {
    return freeze_vertices(tree, corners_, this->metrics_.field(), precision);
}

// The control node at `x`, a place on the border or inside of a leaf with this box and these
// corners; it is as large as the leaf's field there at most.
template <class Node>
NodeIndex VertexValues<Node>::vertex_at(const Point& x, const Box& box, const Corners& corners) {
    const auto weights = corner_weights((x - box.low).cwiseQuotient(divisible_edges(box)));
    const Metric requested = blend_lengths(
        weights, [&](std::size_t i) -> const Metric& { return this->metrics_[corners[i]]; });
    const auto next = static_cast<NodeIndex>(positions_.size());
    if (places_.is_empty()) places_ = PlaceIndex(positions_);
    const NodeIndex node = places_.find_or_enter(x, next, positions_);
    if (node == next) {
        make_room(positions_, 1);
        positions_.push_back(x);
        this->metrics_.append(requested);
    } else {
        this->metrics_.lower(node, requested);
    }
    return node;
}

template <class Node>
void VertexValues<Node>::split(const Subdivision& subdivision, LeafIndex leaf,
                               LeafIndex first_new) {
    const Corners old = corners_[leaf];
    CutLattice lattice(subdivision, old);
    // All are prefetched before the first is waited for.
    const auto places = lattice.new_places();
    for (const auto& place : places) places_.prefetch(place.x);
    for (const auto& place : places) {
        const NodeIndex node = places_.likely_at(place.x);
        if (node >= positions_.size()) continue;
        __builtin_prefetch(&positions_[node]);
        this->metrics_.prefetch(node);
    }
    for (const auto& place : places) lattice.set(place, vertex_at(place.x, subdivision.box, old));

    const int children = subdivision.children();
    make_room(corners_, static_cast<std::size_t>(children - 1));
    corners_.resize(corners_.size() + static_cast<std::size_t>(children - 1));
    for (int c = 0; c < children; ++c) {
        corners_[c == 0 ? leaf : first_new + static_cast<LeafIndex>(c - 1)] = lattice.child(c);
    }
}

template <class Node>
void VertexValues<Node>::collect(const Topology<Node>& tree, std::span<const Metric> requests) {
    LeafVertices vertices = leaf_vertices(tree);
    corners_ = std::move(vertices.of_leaves);
    positions_ = std::move(vertices.positions);
    places_ = PlaceIndex();
    // Each thread intersects at nodes of its own, leaf after leaf.
    std::vector<Metric> metrics = large_array<Metric>(positions_.size());
    const std::size_t shares = threads_allowed();
    tbb::parallel_for(std::size_t{0}, shares, [&](std::size_t share) {
        const auto low = static_cast<NodeIndex>(share * metrics.size() / shares);
        const auto high = static_cast<NodeIndex>((share + 1) * metrics.size() / shares);
        const double unknown = std::numeric_limits<double>::infinity();
        for (NodeIndex node = low; node < high; ++node) metrics[node].xx = unknown;
        for (LeafIndex leaf = 0; leaf < corners_.size(); ++leaf) {
            for (const NodeIndex node : corners_[leaf]) {
                if (node < low || node >= high) continue;
                Metric& m = metrics[node];
                m = m.xx == unknown ? requests[leaf] : intersection(m, requests[leaf]);
            }
        }
    });
    this->metrics_ = NodeMetrics(std::move(metrics));
}

template <class Node>
bool VertexValues<Node>::has_bounds(const GoalField& field) const {
    return field.has_ranges() && !field.kept().empty();
}

template <class Node>
Judgement VertexValues<Node>::judge(const CellBox& leaf, CellJudge& judge) const {
    if (!judge.may_use_bounds()) return judge.by_samples(leaf);
    std::array<double, 8> at_corners;
    std::ranges::transform(corners_[leaf.cell], at_corners.begin(),
                           [&](NodeIndex node) { return this->metrics_[node].xx; });
    return judge.by_bounds(leaf, at_corners);
}

template <class Node>
void VertexValues<Node>::loaded(const Topology<Node>& tree, const StateReader& state) {
    NodeMetrics& metrics = this->metrics_;
    constexpr auto name = "vertices.of_leaves";
    state.require(corners_.size() == tree.leaves(), name, "has another number of leaves");
    require_below(state, name, corners_, metrics.size());
    metrics.require_sound(state, metrics.size());
    places_ = PlaceIndex();  // it waits for the first cut, which needs it
    positions_ = vertex_positions(tree, corners_, metrics.size());
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
        for (int i = 0; i < 8; ++i) {
            const NodeIndex vertex = corners_[leaf][static_cast<std::size_t>(i)];
            state.require(positions_[vertex] == corner(box, i), name, "has a vertex in two places");
        }
    });
}

template <class Node>
void VertexValues<Node>::describe(Footprint& footprint) const {
    this->metrics_.describe(footprint);
    footprint.bytes_topology += corners_.capacity() * sizeof(Corners);
    footprint.bytes_auxiliary += positions_.capacity() * sizeof(Point) + places_.bytes();
}

template <class Node>
void VertexValues<Node>::shrink_to_fit() {
    controlspace::shrink_to_fit(corners_);
    this->metrics_.shrink_to_fit();
    controlspace::shrink_to_fit(positions_);
}

template class VertexValues<KdNode>;
template class VertexValues<OctreeNode>;

}  // namespace controlspace
