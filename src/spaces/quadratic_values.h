#pragma once

#include <array>

#include "spaces/leaf_values.h"
#include "spaces/make_room.h"

namespace controlspace {

/// Metric inside a leaf, interpolated from its own metric and those of its six face neighbours.
///
/// `own` is the leaf's metric; across[2 a] and across[2 a + 1] are the neighbours' on the low and
/// high side of axis a (the leaf's own at the domain's border); `t` is the place in the leaf, each
/// coordinate in [-1, 1]. The 27 nodes of a hexahedron are set to: centre: own; face: mean of own
/// and the neighbour's; edge: mean of its two faces; corner: mean of its three faces; between them
/// the triquadratic Lagrange functions (paper §3.1.2, its coordinates put right).
///
/// Answers `own` at the centre and reproduces a constant. No node is smaller than own / 2, but
/// quadratic functions undershoot; where the result would fall below own / 2 along any direction,
/// its departure from `own` is scaled down until it does not. So it is always positive definite.
///
/// A leaf's face gets the mean of two leaves, far coarser than `own` beside a large neighbour, as
/// beside a source at a cut plane. Where the result would exceed `largest_growth` times `own` along
/// any direction, its departure is scaled down too; at least 1. (Cut off at the coarsest of the
/// seven metrics instead, it is as often coarser than asked, and less accurate.)
Metric triquadratic(const Metric& own, const std::array<Metric, 6>& across, const Vector& t,
                    double largest_growth);

/// The same at the nearest place to `place` in a leaf with this box; nowhere coarser than the cone
/// of the leaf's own metric of this slope (g_r - 1). across_from(x) are the metrics across the
/// faces from there.
template <class AcrossFrom>
Metric triquadratic_in(const Box& box, const Point& place, const Metric& own, double slope,
                       AcrossFrom&& across_from) {
    const Point x = place.cwiseMax(box.low).cwiseMin(box.high);
    const Vector v = x - box.centre();
    const Vector t = 2 * v.cwiseQuotient(box.edges());
    return triquadratic(own, across_from(x), t, 1 + slope * metric_length(own, v));
}

/// One metric a leaf, interpolated with those of the neighbours when asked (K_Li). Nowhere coarser
/// than the cone of the leaf's own metric at its centre, with the ratio of the gradation to come:
/// on the paper's sphere that leaves its Tables 1 and 4 as they are, and divides δ_S by up to 20.
class QuadraticValues : public LeafValues {
public:
    static constexpr int order = 2;
    static constexpr CutBy cut_by = CutBy::faces;

    explicit QuadraticValues(const SpaceOptions& options)
        : LeafValues(options), boxes_(1, options.domain), slope_(options.ratio - 1) {}

    template <class Node>
    Metric value(const Topology<Node>& tree, const Point& x) const {
        return interpolate(tree, tree.find(x), x, metrics_.field());
    }
    template <class Node>
    Metric value_in(const Topology<Node>& tree, LeafIndex leaf, const Point& x) const {
        return interpolate(tree, leaf, x, metrics_.field());
    }
    void prefetch(LeafIndex leaf) const { __builtin_prefetch(&boxes_[leaf]); }
    template <class Node>
    Metric asked(const Topology<Node>& tree, const Point& x) const {
        return interpolate(tree, tree.find(x), x, metrics_.asked());
    }

    template <class Node>
    std::unique_ptr<ControlSpace> freeze(const Topology<Node>& tree, Precision precision) const {
        return freeze_quadratic(tree, metrics_.field(), slope_, precision);
    }

    double ceiling(LeafIndex leaf, const Point& x) const {
        return LeafValues::ceiling(leaf, x) + slope_ * boxes_[leaf].half_diagonal();
    }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) {
        LeafValues::split(subdivision, leaf, first_new);
        make_room(boxes_, static_cast<std::size_t>(subdivision.children() - 1));
        boxes_[leaf] = subdivision.child(0);
        for (int c = 1; c < subdivision.children(); ++c) boxes_.push_back(subdivision.child(c));
    }

    template <class Node>
    void load(const Topology<Node>& tree, const StateReader& state) {
        LeafValues::load(tree, state);
        boxes_.resize(tree.leaves());
        tree.for_each_leaf([&](LeafIndex leaf, const Box& box) { boxes_[leaf] = box; });
    }

    void describe(Footprint& footprint) const {
        LeafValues::describe(footprint);
        footprint.bytes_auxiliary += boxes_.capacity() * sizeof(Box);
    }
    void shrink_to_fit() {
        LeafValues::shrink_to_fit();
        boxes_.shrink_to_fit();
    }

private:
    template <class Node>
    Metric interpolate(const Topology<Node>& tree, LeafIndex leaf, const Point& place,
                       std::span<const Metric> metrics) const {
        const Box& box = boxes_[leaf];
        return triquadratic_in(box, place, metrics[leaf], slope_, [&](const Point& x) {
            std::array<Point, 6> beyond;
            std::array<LeafIndex, 6> neighbours;
            for (int face = 0; face < 6; ++face) {
                Point& y = beyond[static_cast<std::size_t>(face)];
                y = x;
                step_across(tree.domain(), box, face, y);
            }
            tree.find(beyond, neighbours);
            std::array<Metric, 6> across;
            for (std::size_t face = 0; face < 6; ++face) across[face] = metrics[neighbours[face]];
            return across;
        });
    }

    std::vector<Box> boxes_;  // of the leaves
    double slope_;            // g_r - 1
};

}  // namespace controlspace
