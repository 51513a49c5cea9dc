// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/trees/detail/departure.h"
#include "controlspace/trees/detail/in_parallel.h"
#include "controlspace/trees/detail/sample_leaves.h"
#include "controlspace/trees/detail/single_cones.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// Finds where the metric of a leaf exceeds the cone of a single source: there the exact field may
/// have a minimum that no other place of the leaf shows.
template <class Node, class Storage>
class NextToSources {
public:
    /// So few are compared with all leaves, whatever these hold.
    static constexpr std::size_t few = 64;

    /// The sources must outlive it.
    NextToSources(const Topology<Node>& tree, const Storage& storage, const GoalField& field,
                  std::span<const PointSource> sources)
        : tree_(tree), storage_(storage), field_(field), sources_(sources) {}

    /// Before a round of `worst_in`. Few sources are compared with all leaves there, many, here,
    /// with those leaves beside their own of which `is_wanted(leaf)` holds; `is_new(leaf)` of all
    /// that have been cut since the last time, at least.
    template <class IsNew, class IsWanted>
    void find_beside(const IsNew& is_new, const IsWanted& is_wanted) {
        if (!cones_) cones_.emplace(sources_, field_.ratio(), field_.target());
        if (are_few()) return;
        beside_.assign(tree_.leaves(), {});
        tbb::enumerable_thread_specific<std::vector<std::pair<LeafIndex, Departure>>> found;
        around_.resize(sources_.size());
        in_parallel(sources_.size(), [&](std::size_t i) {
            // A leaf that is cut stays as one of its parts: those not new are as they were.
            if (std::ranges::none_of(around_[i], is_new)) return;
            const LeafPlace own = tree_.locate(sources_[i].position);
            around_[i].fill(own.leaf);
            std::size_t next = 1;
            for_each_leaf_beside(own.box, sources_[i].position, [&](const LeafPlace& beside) {
                around_[i][next++] = beside.leaf;
                if (!is_wanted(beside.leaf) || !may_exceed(i, beside)) return;
                const Departure departure =
                    cones_->at_nearest_place(i, beside.box, metric_in(beside.leaf));
                if (departure.worst > 0) found.local().emplace_back(beside.leaf, departure);
            });
        });
        for (const auto& of_thread : found) {
            for (const auto& [leaf, departure] : of_thread) beside_[leaf].take(departure);
        }
    }

    /// The place where the leaf exceeds a single cone most, and an estimate of its departure from
    /// the field there; nothing if that is far below the target. Of few sources, appends to
    /// `further` where it exceeds cones, and places around the tips of cones.
    Departure worst_in(const LeafBox& of, std::vector<Point>& further) const {
        if (!are_few()) return beside_[of.leaf];
        // Corners are among the places of the leaf, and where it is trilinear, edges are searched.
        cones_->append_around_tips(of.box, HasTrilinearLeaves<Storage> ? 1 : 2, further);
        Departure worst;
        if constexpr (HasTrilinearLeaves<Storage>) {
            worst = cones_->worst_in(of.box, at_corners(of.leaf), metric_in(of.leaf), &further);
        } else {
            for (std::size_t k = 0; k < sources_.size(); ++k) {
                worst.take(cones_->at_nearest_place(k, of.box, metric_in(of.leaf), &further));
            }
        }
        return worst;
    }

private:
    // Whether all are compared with every leaf, which takes less time where leaves are trilinear.
    bool are_few() const {
        return field_.has_sources_up_to(HasTrilinearLeaves<Storage> ? GoalField::few_sources : few);
    }

    std::array<Metric, 8> at_corners(LeafIndex leaf) const {
        std::array<Metric, 8> metrics;
        const auto field = storage_.metrics().field();
        std::ranges::transform(storage_.nodes_of(leaf), metrics.begin(),
                               [&](const auto node) { return field[node]; });
        return metrics;
    }

    bool may_exceed(std::size_t source, const LeafPlace& place) const {
        if constexpr (!HasTrilinearLeaves<Storage>)
            return true;
        else
            return cones_->may_be_exceeded(source, place.box, at_corners(place.leaf));
    }

    auto metric_in(LeafIndex leaf) const {
        return
            [this, leaf](const Point& x) { return value_in(tree_, field_of(storage_), leaf, x); };
    }

    // Across the nearest faces, edges and corner of the box, which holds x.
    template <class Visit>
    void for_each_leaf_beside(const Box& box, const Point& x, const Visit& visit) const {
        const Point centre = box.centre();
        constexpr double infinity = std::numeric_limits<double>::infinity();
        for (int sides = 1; sides < 8; ++sides) {
            Point p = x;
            for (Axis a = 0; a < 3; ++a) {
                if ((sides >> a & 1) == 0) continue;
                p[a] = x[a] < centre[a] ? std::nextafter(box.low[a], -infinity)
                                        : std::nextafter(box.high[a], infinity);
            }
            if (tree_.domain().contains(p)) visit(tree_.locate(p));
        }
    }

    const Topology<Node>& tree_;
    const Storage& storage_;
    const GoalField& field_;
    std::span<const PointSource> sources_;
    std::optional<SingleCones> cones_;              // once they are needed
    std::vector<Departure> beside_;                 // of the leaves, where sources are many
    std::vector<std::array<LeafIndex, 8>> around_;  // each source, then: its leaf and those beside
};

}  // namespace controlspace
