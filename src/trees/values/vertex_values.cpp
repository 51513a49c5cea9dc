#include "trees/values/vertex_values.h"

#include <algorithm>
#include <utility>

#include "controlspace/trees/detail/make_room.h"

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
    const Metric requested = interpolate(corners, weights, metrics_.requested());
    const auto next = static_cast<NodeIndex>(positions_.size());
    if (places_.is_empty()) places_ = PlaceIndex(positions_);
    const NodeIndex node = places_.find_or_enter(x, next, positions_);
    if (node == next) {
        make_room(positions_, 1);
        positions_.push_back(x);
        metrics_.append(requested, metrics_.keeps_requested()
                                       ? interpolate(corners, weights, metrics_.field())
                                       : requested);
    } else {
        metrics_.lower(node, requested);
    }
    return node;
}

void VertexValues::split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) {
    // The children's corners stand on a lattice of up to 3 x 3 x 3 places: per axis the low face,
    // the cut and the high face. Those that are not corners of the leaf are searched, once each.
    const Corners old = corners_[leaf];
    const Box& box = subdivision.box;
    constexpr NodeIndex unknown = ~NodeIndex{0}, searched = unknown - 1;
    std::array<NodeIndex, 27> lattice;
    lattice.fill(unknown);
    struct Place {
        std::size_t at;  // in the lattice
        Point x;
    };
    std::array<Place, 19> fresh;
    std::size_t count = 0;
    const auto enter = [&](const std::array<int, 3>& step) {
        const auto at = static_cast<std::size_t>(step[0] + 3 * step[1] + 9 * step[2]);
        if (lattice[at] != unknown) return at;
        Point x;
        int old_corner = 0;
        bool is_old = true;
        for (Axis a = 0; a < 3; ++a) {
            const int s = step[static_cast<std::size_t>(a)];
            x[a] = s == 0 ? box.low[a] : s == 1 ? subdivision.at[a] : box.high[a];
            old_corner |= (s / 2) << a;
            is_old = is_old && s != 1;
        }
        lattice[at] = is_old ? old[static_cast<std::size_t>(old_corner)] : searched;
        if (!is_old) fresh[count++] = {at, x};
        return at;
    };

    const int children = subdivision.children();
    std::array<std::array<std::size_t, 8>, 8> corners_at;  // in the lattice
    for (int c = 0; c < children; ++c) {
        for (int i = 0; i < 8; ++i) {
            std::array<int, 3> step{};
            for (Axis a = 0; a < 3; ++a) {
                const auto axis = static_cast<std::size_t>(a);
                const int bit = i >> a & 1;
                const int high = box.low[a] < box.high[a] ? 2 : 0;
                step[axis] = subdivision.cuts[axis] ? subdivision.side(c, a) + bit : high * bit;
            }
            corners_at[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] = enter(step);
        }
    }
    // All are prefetched before the first is waited for.
    const auto places = std::span(fresh).first(count);
    for (const Place& place : places) places_.prefetch(place.x);
    for (const Place& place : places) {
        const NodeIndex node = places_.likely_at(place.x);
        if (node >= positions_.size()) continue;
        __builtin_prefetch(&positions_[node]);
        metrics_.prefetch(node);
    }
    for (const Place& place : places) lattice[place.at] = vertex_at(place.x, box, old);

    make_room(corners_, static_cast<std::size_t>(children - 1));
    corners_.resize(corners_.size() + static_cast<std::size_t>(children - 1));
    for (int c = 0; c < children; ++c) {
        const LeafIndex child = c == 0 ? leaf : first_new + static_cast<LeafIndex>(c - 1);
        for (std::size_t i = 0; i < 8; ++i) {
            corners_[child][i] = lattice[corners_at[static_cast<std::size_t>(c)][i]];
        }
    }
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
