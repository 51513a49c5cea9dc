// SPDX-License-Identifier: Apache-2.0
#include "trees/values/quadratic_values.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "space/state.h"
#include "trees/make_room.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/adjacency.h"
#include "trees/values/quadratic_in_leaves.h"

namespace controlspace {

/// What QuadraticInLeaves reads.
template <class Node>
struct QuadraticValues<Node>::Values {
    const Topology<Node>& tree;
    const QuadraticValues& own;
    std::span<const Metric> metrics;
    double ratio_slope;

    const Box& box(LeafIndex leaf) const { return own.boxes_[leaf]; }
    const Metric& metric(LeafIndex leaf) const { return metrics[leaf]; }
    void prefetch_metric(LeafIndex leaf) const { __builtin_prefetch(&metrics[leaf]); }
    double length(LeafIndex leaf) const { return metrics[leaf].xx; }
    bool all_isotropic() const { return own.isotropic_; }
    double slope() const { return ratio_slope; }
    QuadraticForm form() const { return own.form_; }
    PartsAcross parts_across(LeafIndex leaf, const Point& x) const {
        return own.across_.empty() ? find_across(leaf, x) : own.across_[leaf];
    }

private:
    PartsAcross find_across(LeafIndex leaf, const Point& x) const {
        std::array<Point, 6> beyond;
        std::array<LeafIndex, 6> neighbours;
        for (int face = 0; face < 6; ++face) {
            Point& y = beyond[static_cast<std::size_t>(face)];
            y = x;
            step_across(tree.domain(), box(leaf), face, y);
        }
        tree.find(beyond, neighbours);
        PartsAcross across;
        std::transform(neighbours.begin(), neighbours.end(), across.begin(), Ref::leaf);
        return across;
    }
};

template <class Node>
QuadraticValues<Node>::QuadraticValues(const SpaceOptions& options)
    : Base(options, model_traits),
      boxes_(1, options.domain),
      requested_slope_(options.ratio - 1),
      slope_(requested_slope_),
      form_(options.quadratic_form) {}

template <class Node>
template <class Value>
[[gnu::always_inline]] inline void QuadraticValues<Node>::interpolate(
    const Topology<Node>& tree, std::span<const LeafIndex> leaves, std::span<const Point> x,
    double slope, std::span<Value> out) const {
    const Values values{tree, *this, this->metrics_.field(), slope};
    QuadraticInLeaves(tree, values).interpolate(leaves, x, out);
}

template <class Node>
void QuadraticValues<Node>::prefetch(std::span<const LeafIndex> leaves) const {
    if (leaves.size() == 1) return;
    for (const LeafIndex leaf : leaves) {
        __builtin_prefetch(&boxes_[leaf]);
        if (!across_.empty()) __builtin_prefetch(&across_[leaf]);
    }
}

template <class Node>
void QuadraticValues<Node>::values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                                   std::span<const Point> x, std::span<Metric> out) const {
    prefetch(leaves);
    interpolate(tree, leaves, x, slope_, out);
}

template <class Node>
void QuadraticValues<Node>::lengths(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                                    std::span<const Point> x, std::span<double> out) const {
    prefetch(leaves);
    interpolate(tree, leaves, x, slope_, out);
}

template <class Node>
Metric QuadraticValues<Node>::requested(const Topology<Node>& tree, LeafIndex leaf,
                                        const Point& x) const {
    Metric m;
    interpolate(tree, {&leaf, 1}, {&x, 1}, requested_slope_, std::span(&m, 1));
    return m;
}

template <class Node>
void QuadraticValues<Node>::ceilings(const Topology<Node>&, std::span<const LeafIndex> leaves,
                                     std::span<const Point>, std::span<double> out) const {
    prefetch(leaves);
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const Metric& m = this->metrics_[leaves[i]];
        out[i] = form_ == QuadraticForm::published || !is_isotropic(m)
                     ? std::numeric_limits<double>::infinity()
                     : m.xx + requested_slope_ * boxes_[leaves[i]].half_diagonal();
    }
}

template <class Node>
std::unique_ptr<ControlSpace> QuadraticValues<Node>::compact(const Topology<Node>& tree,
                                                             Precision precision) const {
    return freeze_quadratic(tree, this->metrics_.field(), {slope_, form_}, precision);
}

template <class Node>
void QuadraticValues<Node>::split(const Subdivision& subdivision, LeafIndex leaf,
                                  LeafIndex first_new) {
    Base::split(subdivision, leaf, first_new);
    make_room(boxes_, static_cast<std::size_t>(subdivision.children() - 1));
    boxes_[leaf] = subdivision.child(0);
    for (int c = 1; c < subdivision.children(); ++c) boxes_.push_back(subdivision.child(c));
    if (!across_.empty()) across_ = {};
}

template <class Node>
void QuadraticValues<Node>::lower(const CellBox& leaf, const Metric& metric) {
    this->metrics_.lower(leaf.cell, metric);
    isotropic_ = isotropic_ && is_isotropic(metric);
}

template <class Node>
void QuadraticValues<Node>::assigned() {
    isotropic_ = std::ranges::all_of(this->metrics_.field(), is_isotropic);
}

template <class Node>
void QuadraticValues<Node>::graded(double ratio) {
    slope_ = ratio - 1;
    assigned();
}

template <class Node>
void QuadraticValues<Node>::prepare(const Topology<Node>& tree) {
    if (!across_.empty()) return;
    across_.resize(tree.leaves());
    for_each_parts_across(
        tree, [&](LeafIndex leaf, const Box&, const PartsAcross& parts) { across_[leaf] = parts; });
}

template <class Node>
void QuadraticValues<Node>::loaded(const Topology<Node>& tree, const StateReader& state) {
    this->metrics_.require_sound(state, tree.leaves());
    state.require(std::isfinite(slope_) && slope_ >= 0, "quadratic.slope", "is no slope");
    assigned();
    tbb::parallel_invoke([&] { boxes_.resize(tree.leaves()); },
                         [&] { across_.resize(tree.leaves()); });
    for_each_parts_across(tree, [&](LeafIndex leaf, const Box& box, const PartsAcross& parts) {
        boxes_[leaf] = box;
        across_[leaf] = parts;
    });
}

template <class Node>
void QuadraticValues<Node>::describe(Footprint& footprint) const {
    this->metrics_.describe(footprint);
    footprint.bytes_auxiliary +=
        boxes_.capacity() * sizeof(Box) + across_.capacity() * sizeof(PartsAcross);
}

template <class Node>
void QuadraticValues<Node>::shrink_to_fit() {
    this->metrics_.shrink_to_fit();
    controlspace::shrink_to_fit(boxes_);
}

template class QuadraticValues<KdNode>;
template class QuadraticValues<OctreeNode>;

}  // namespace controlspace
