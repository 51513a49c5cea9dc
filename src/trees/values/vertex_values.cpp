// SPDX-License-Identifier: Apache-2.0
#include "trees/values/vertex_values.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "controlspace/metric/intersection.h"
#include "controlspace/trees/detail/make_room.h"
#include "geometry/threads.h"
#include "trees/topology/cut_lattice.h"

namespace controlspace {

VertexValues::VertexValues(const SpaceOptions& options) : corners_(1), metrics_(0, Metric()) {
    for (int i = 0; i < 8; ++i) {
        const Point x = corner(options.domain, i);
        const auto next = static_cast<NodeIndex>(positions_.size());
        const NodeIndex node = places_.find_or_enter(x, next, positions_);
        if (node == next) positions_.push_back(x);  // those of a flat domain coincide
        corners_[0][static_cast<std::size_t>(i)] = node;
    }
    metrics_ = NodeMetrics(positions_.size(), largest_metric(options));
}

// The control node at `x`, a place on the border or inside of a leaf with this box and these
// corners; it is as large as the leaf's field there at most.
NodeIndex VertexValues::vertex_at(const Point& x, const Box& box, const Corners& corners) {
    const auto weights = corner_weights((x - box.low).cwiseQuotient(divisible_edges(box)));
    const Metric requested = interpolate(corners, weights, metrics_.field());
    const auto next = static_cast<NodeIndex>(positions_.size());
    if (places_.is_empty()) places_ = PlaceIndex(positions_);
    const NodeIndex node = places_.find_or_enter(x, next, positions_);
    if (node == next) {
        make_room(positions_, 1);
        positions_.push_back(x);
        metrics_.append(requested);
    } else {
        metrics_.lower(node, requested);
    }
    return node;
}

void VertexValues::split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) {
    const Corners old = corners_[leaf];
    CutLattice lattice(subdivision, old);
    // All are prefetched before the first is waited for.
    const auto places = lattice.new_places();
    for (const auto& place : places) places_.prefetch(place.x);
    for (const auto& place : places) {
        const NodeIndex node = places_.likely_at(place.x);
        if (node >= positions_.size()) continue;
        __builtin_prefetch(&positions_[node]);
        metrics_.prefetch(node);
    }
    for (const auto& place : places) lattice.set(place, vertex_at(place.x, subdivision.box, old));

    const int children = subdivision.children();
    make_room(corners_, static_cast<std::size_t>(children - 1));
    corners_.resize(corners_.size() + static_cast<std::size_t>(children - 1));
    for (int c = 0; c < children; ++c) {
        corners_[c == 0 ? leaf : first_new + static_cast<LeafIndex>(c - 1)] = lattice.child(c);
    }
}

void VertexValues::enter(LeafVertices vertices, std::span<const Metric> of_leaves) {
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
                Metric& own = metrics[node];
                own = own.xx == unknown ? of_leaves[leaf] : intersection(own, of_leaves[leaf]);
            }
        }
    });
    metrics_ = NodeMetrics(std::move(metrics));
}

void VertexValues::require_sound(const StateReader& state, std::size_t leaves) {
    state.require(corners_.size() == leaves, "vertices.of_leaves", "has another number of leaves");
    require_below(state, "vertices.of_leaves", corners_, metrics_.size());
    metrics_.require_sound(state, metrics_.size());
    places_ = PlaceIndex();
}

void VertexValues::describe(Footprint& footprint) const {
    metrics_.describe(footprint);
    footprint.bytes_topology += corners_.capacity() * sizeof(Corners);
    footprint.bytes_auxiliary += positions_.capacity() * sizeof(Point) + places_.bytes();
}

void VertexValues::shrink_to_fit() {
    controlspace::shrink_to_fit(corners_);
    metrics_.shrink_to_fit();
    controlspace::shrink_to_fit(positions_);
}

}  // namespace controlspace
