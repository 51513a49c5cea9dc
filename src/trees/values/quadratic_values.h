// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "controlspace/trees/detail/make_room.h"
#include "controlspace/trees/leaf_metrics.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/parts_across.h"
#include "trees/values/quadratic_in_leaves.h"

namespace controlspace {

/// One metric a leaf, interpolated with those of its face neighbours (K_Li, K_oLi; paper §3.1.2).
/// Nowhere coarser than the cone of the leaf's own metric at its centre, with the ratio of the last
/// gradation, or of the one to come: on the paper's sphere that leaves its Tables 1 and 4 as they
/// are, and divides δ_S by up to 20.
class QuadraticValues : public LeafMetrics {
public:
    static constexpr int order = 2;
    static constexpr CutBy cut_by = CutBy::faces;
    static constexpr bool follows_neighbours = true;

    explicit QuadraticValues(const SpaceOptions& options)
        : LeafMetrics(options),
          boxes_(1, options.domain),
          requested_slope_(options.ratio - 1),
          slope_(requested_slope_),
          form_(options.quadratic_form) {}

    void prefetch(LeafIndex leaf) const {
        __builtin_prefetch(&boxes_[leaf]);
        if (!across_.empty()) __builtin_prefetch(&across_[leaf]);
    }
    template <class Node, class Value>
    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, const NodeView<Metric>& nodes,
                   std::span<Value> out) const {
        const double slope = nodes.are_requested ? requested_slope_ : slope_;
        const Values<Node> values{tree, *this, nodes, slope};
        QuadraticInLeaves(tree, values).interpolate(leaves, x, out);
    }

    template <class Node>
    std::unique_ptr<ControlSpace> pack(const Topology<Node>& tree, Precision precision) const {
        return freeze_quadratic(tree, metrics_.field(), {slope_, form_}, precision);
    }

    double ceiling(LeafIndex leaf, const Point&) const {
        const Metric& m = metrics_[leaf];
        if (form_ == QuadraticForm::published || !is_isotropic(m)) {
            return std::numeric_limits<double>::infinity();
        }
        return m.xx + requested_slope_ * boxes_[leaf].half_diagonal();
    }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) {
        LeafMetrics::split(subdivision, leaf, first_new);
        make_room(boxes_, static_cast<std::size_t>(subdivision.children() - 1));
        boxes_[leaf] = subdivision.child(0);
        for (int c = 1; c < subdivision.children(); ++c) boxes_.push_back(subdivision.child(c));
        if (!across_.empty()) across_ = {};
    }

    void lower(const LeafPlace& place, const Metric& metric) {
        metrics_.lower(place.leaf, metric);
        isotropic_ = isotropic_ && is_isotropic(metric);
    }
    void assigned() { isotropic_ = std::ranges::all_of(metrics_.field(), is_isotropic); }
    void graded(double ratio) {
        slope_ = ratio - 1;
        assigned();
    }

    static void data(auto& self, auto&& visit) { visit("quadratic.slope", self.slope_); }
    template <class Node>
    void loaded(const Topology<Node>& tree, const StateReader& state) {
        metrics_.require_sound(state, tree.leaves());
        state.require(std::isfinite(slope_) && slope_ >= 0, "quadratic.slope", "is no slope");
        assigned();
        tbb::parallel_invoke([&] { boxes_.resize(tree.leaves()); },
                             [&] { across_.resize(tree.leaves()); });
        for_each_parts_across(tree, [&](LeafIndex leaf, const Box& box, const PartsAcross& parts) {
            boxes_[leaf] = box;
            across_[leaf] = parts;
        });
    }

    /// Makes queries faster until a leaf is split.
    template <class Node>
    void prepare(const Topology<Node>& tree) {
        if (!across_.empty()) return;
        across_.resize(tree.leaves());
        for_each_parts_across(tree, [&](LeafIndex leaf, const Box&, const PartsAcross& parts) {
            across_[leaf] = parts;
        });
    }

    void describe(Footprint& footprint) const {
        metrics_.describe(footprint);
        footprint.bytes_auxiliary +=
            boxes_.capacity() * sizeof(Box) + across_.capacity() * sizeof(PartsAcross);
    }
    void shrink_to_fit() {
        metrics_.shrink_to_fit();
        controlspace::shrink_to_fit(boxes_);
    }

private:
    /// What QuadraticInLeaves reads.
    template <class Node>
    struct Values {
        const Topology<Node>& tree;
        const QuadraticValues& own;
        NodeView<Metric> metrics;
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

    std::vector<Box> boxes_;           // of the leaves
    std::vector<PartsAcross> across_;  // of the leaves; empty where they are not known
    // g_r - 1: of the field before gradation, which insertion compares with, and of the graded one.
    double requested_slope_, slope_;
    QuadraticForm form_;
    bool isotropic_ = true;  // all metrics are; false where that is not known
};

}  // namespace controlspace
