#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>

#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"
#include "space/state.h"
#include "trees/adaptation/leaf_judge.h"
#include "trees/packing/frozen_tree.h"
#include "trees/regradation/leaf_changes.h"
#include "trees/topology/topology.h"
#include "trees/values/node_metrics.h"

namespace controlspace {

/// One metric a leaf, constant over it (K_L, K_oL): a control node stands at the leaf's centre.
class LeafValues {
public:
    static constexpr int order = 0;
    static constexpr CutBy cut_by = CutBy::corners;
    static constexpr bool follows_neighbours = false;
    using Changes = LeafChanges;

    explicit LeafValues(const SpaceOptions& options)
        : metrics_(1, largest_metric(options.domain)) {}

    template <class Node>
    Metric value(const Topology<Node>& tree, const Point& x) const {
        return metrics_[tree.find(x)];
    }
    template <class Node>
    const Metric& value_in(const Topology<Node>&, LeafIndex leaf, const Point&) const {
        return metrics_[leaf];
    }
    template <class Node>
    Metric asked(const Topology<Node>& tree, const Point& x) const {
        return metrics_.asked()[tree.find(x)];
    }

    double ceiling(LeafIndex leaf, const Point&) const {
        const Metric& m = metrics_.asked()[leaf];
        return is_isotropic(m) ? m.xx : std::numeric_limits<double>::infinity();
    }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) {
        metrics_.repeat(leaf, static_cast<std::size_t>(subdivision.children() - 1));
    }

    NodeMetrics& metrics() { return metrics_; }
    const NodeMetrics& metrics() const { return metrics_; }
    static std::array<NodeIndex, 1> nodes_of(LeafIndex leaf) { return {leaf}; }

    template <class Node>
    std::unique_ptr<ControlSpace> freeze(const Topology<Node>& tree, Precision precision) const {
        return freeze_leaves(tree, metrics_.field(), precision);
    }

    void save(StateWriter& state) const { NodeMetrics::exchange(metrics_, state); }
    template <class Node>
    void load(const Topology<Node>& tree, const StateReader& state) {
        NodeMetrics::exchange(metrics_, state);
        metrics_.require_sound(state, tree.leaves());
    }

    void describe(Footprint& footprint) const { metrics_.describe(footprint); }
    void shrink_to_fit() { metrics_.shrink_to_fit(); }

protected:
    NodeMetrics metrics_;
};

}  // namespace controlspace
