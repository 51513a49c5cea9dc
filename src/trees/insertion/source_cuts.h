// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "controlspace/sources/point_source.h"
#include "controlspace/space/space_options.h"
#include "controlspace/space/split_rule.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// The deepest level of trees of this cut.
template <class Node>
constexpr int deepest_level = Node::is_octant ? deepest_octree_level : deepest_kd_level;

/// How a tree's leaves are cut for sources (paper §3.1, steps 4 and 5).
template <class Node>
class SourceCuts {
public:
    /// `options` must outlive it. No leaf of the level `deepest` is cut, whatever they say.
    explicit SourceCuts(const SpaceOptions& options, int deepest = deepest_level<Node>)
        : options_(options), deepest_(deepest) {}

    /// The cut of the leaf that holds the source; none where the leaf is short enough, or among the
    /// smallest allowed.
    std::optional<Subdivision> cut(const LeafPlace& place, const PointSource& source) const {
        if (place.level >= max_depth() || !is_too_long(source.metric, place.box)) return {};
        const Subdivision subdivision = subdivide(place, source);
        if (!subdivision.is_proper()) return {};
        return subdivision;
    }

    int max_depth() const {
        return std::min(deepest_, Node::is_octant
                                      ? options_.octree_depth.value_or(usual_octree_level)
                                      : options_.kd_depth.value_or(usual_kd_level));
    }

    /// Whether any edge of `box` is longer than l_min in the metric.
    bool is_too_long(const Metric& metric, const Box& box) const {
        const auto lengths = metric_edge_lengths(metric, box.edges());
        return std::max({lengths[0], lengths[1], lengths[2]}) > options_.l_min;
    }

private:
    Subdivision subdivide(const LeafPlace& place, const PointSource& source) const {
        if constexpr (Node::is_octant) {
            return Node::even_subdivision(options_.domain, place.level, place.box);
        } else {
            return controlspace::cut(options_.split, place.box, source, options_.l_min);
        }
    }

    const SpaceOptions& options_;
    int deepest_;
};

}  // namespace controlspace
