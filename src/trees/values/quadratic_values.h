#pragma once

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "trees/topology/make_room.h"
#include "trees/topology/parts_across.h"
#include "trees/values/leaf_values.h"
#include "trees/values/quadratic_in_leaves.h"

namespace controlspace {

/// One metric a leaf, interpolated with those of the neighbours when asked (K_Li). Nowhere coarser
/// than the cone of the leaf's own metric at its centre, with the ratio of the last gradation, or
/// of the one to come: on the paper's sphere that leaves its Tables 1 and 4 as they are, and
/// divides δ_S by up to 20.
class QuadraticValues : public LeafValues {
public:
    static constexpr int order = 2;
    static constexpr CutBy cut_by = CutBy::faces;
    static constexpr bool follows_neighbours = true;

    explicit QuadraticValues(const SpaceOptions& options)
        : LeafValues(options),
          boxes_(1, options.domain),
          requested_slope_(options.ratio - 1),
          slope_(requested_slope_),
          form_(options.quadratic_form) {}

    template <class Node>
    Metric value(const Topology<Node>& tree, const Point& x) const {
        return value_at(tree, x, metrics_.field(), slope_);
    }
    template <class Node>
    Metric asked(const Topology<Node>& tree, const Point& x) const {
        return value_at(tree, x, metrics_.asked(), requested_slope_);
    }
    void prefetch(LeafIndex leaf) const {
        __builtin_prefetch(&boxes_[leaf]);
        if (!across_.empty()) __builtin_prefetch(&across_[leaf]);
    }
    template <class Node>
    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Metric> out) const {
        interpolate(tree, leaves, x, out, metrics_.field(), slope_);
    }

    template <class Node>
    std::unique_ptr<ControlSpace> freeze(const Topology<Node>& tree, Precision precision) const {
        return freeze_quadratic(tree, metrics_.field(), {slope_, form_}, precision);
    }

    double ceiling(LeafIndex leaf, const Point& x) const {
        if (form_ == QuadraticForm::published) return std::numeric_limits<double>::infinity();
        return LeafValues::ceiling(leaf, x) + requested_slope_ * boxes_[leaf].half_diagonal();
    }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) {
        LeafValues::split(subdivision, leaf, first_new);
        make_room(boxes_, static_cast<std::size_t>(subdivision.children() - 1));
        boxes_[leaf] = subdivision.child(0);
        for (int c = 1; c < subdivision.children(); ++c) boxes_.push_back(subdivision.child(c));
        if (!across_.empty()) across_ = {};
    }

    /// All metrics have been set, or some intersected with one.
    void refresh() {
        isotropic_ = std::ranges::all_of(metrics_.field(), is_isotropic) &&
                     std::ranges::all_of(metrics_.asked(), is_isotropic);
    }
    void refresh(const Metric& metric) { isotropic_ = isotropic_ && is_isotropic(metric); }
    void set_ratio(double ratio) { slope_ = ratio - 1; }

    void save(StateWriter& state) const {
        LeafValues::save(state);
        state("quadratic.slope", slope_);
    }
    template <class Node>
    void load(const Topology<Node>& tree, const StateReader& state) {
        LeafValues::load(tree, state);
        state("quadratic.slope", slope_);
        state.require(std::isfinite(slope_) && slope_ >= 0, "quadratic.slope", "is no slope");
        refresh();
        tbb::parallel_invoke([&] { boxes_.resize(tree.leaves()); },
                             [&] { across_.resize(tree.leaves()); });
        for_each_parts_across(tree, [&](LeafIndex leaf, const Box& box, const PartsAcross& parts) {
            boxes_[leaf] = box;
            across_[leaf] = parts;
        });
    }

    /// Makes answers faster until a leaf is split.
    template <class Node>
    void remember_parts(const Topology<Node>& tree) {
        if (!across_.empty()) return;
        across_.resize(tree.leaves());
        for_each_parts_across(tree, [&](LeafIndex leaf, const Box&, const PartsAcross& parts) {
            across_[leaf] = parts;
        });
    }

    void describe(Footprint& footprint) const {
        LeafValues::describe(footprint);
        footprint.bytes_auxiliary +=
            boxes_.capacity() * sizeof(Box) + across_.capacity() * sizeof(PartsAcross);
    }
    void shrink_to_fit() {
        LeafValues::shrink_to_fit();
        controlspace::shrink_to_fit(boxes_);
    }

private:
    /// What QuadraticInLeaves wants to know of them.
    template <class Node>
    struct Values {
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
    void interpolate(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                     std::span<const Point> x, std::span<Metric> out,
                     std::span<const Metric> metrics, double slope) const {
        const Values<Node> values{tree, *this, metrics, slope};
        QuadraticInLeaves(tree, values).interpolate(leaves, x, out);
    }
    template <class Node>
    Metric value_at(const Topology<Node>& tree, const Point& x, std::span<const Metric> metrics,
                    double slope) const {
        const LeafIndex leaf = tree.find(x);
        Metric m;
        interpolate(tree, {&leaf, 1}, {&x, 1}, {&m, 1}, metrics, slope);
        return m;
    }

    std::vector<Box> boxes_;           // of the leaves
    std::vector<PartsAcross> across_;  // of the leaves; empty where they are not known
    // g_r - 1: of the field before gradation, which insertion compares with, and of the graded one.
    double requested_slope_, slope_;
    QuadraticForm form_;
    bool isotropic_ = true;  // all metrics are; false where that is not known
};

}  // namespace controlspace
