#pragma once

#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/space/control_nodes.h"
#include "controlspace/space/space_options.h"
#include "space/state.h"
#include "trees/adaptation/adapt_tree.h"
#include "trees/packing/frozen_tree.h"
#include "trees/regradation/leaf_changes.h"
#include "trees/topology/adjacency.h"
#include "trees/topology/leaf_graph.h"
#include "trees/topology/topology.h"
#include "trees/values/node_metrics.h"

namespace controlspace {

// A storage says where the control nodes of a tree are and how the metric between them is made.
// What Tree asks of one:
//   value(tree, x)                       metric at x
//   value_in(tree, leaf, x)              the same where the leaf that holds x is known; or
//   values_in(tree, leaves, x, out)      the same for many
//   prefetch(leaf)                       what that will read first, if it is worth it
//   asked(tree, x)                       the same before gradation (see NodeMetrics)
//   ceiling(leaf, x)                     length that what is asked for at x, in this leaf, will
//                                        not exceed by more than rounding as long as isotropic
//                                        sources come; infinite where that is not known
//   split(subdivision, leaf, first_new)  a leaf was cut; the field stays as it was
//   lower(place, source)                 intersects what governs the leaf with the source
//   grows_by_leaf                        what is asked for in a leaf is its own metric alone: then
//   grow(leaves), metrics()              do the same for many leaves at once (LeafGrowth)
//   fit(tree, leaves, field, proved)     sets the control nodes of these leaves to the field; if
//                                        that will not be proved elsewhere, less closely
//   is_fitted(leaf)                      is known to follow the field at the leaf's own places
//   follows_neighbours                   the field in a leaf varies with what its neighbours hold
//   learn(leaf, x, field)                follows the field better at x, or returns false
//   control_nodes(tree, neighbourhood), assign(tree, metrics), describe(footprint), shrink_to_fit()
//   remember_parts(tree)                 if it has that: makes answers faster until a leaf is split
//   save(state), load(tree, state)       all that it holds, but for what options give
// and, if it holds metrics,
//   grade(tree, options)                 the same as grading control_nodes and assigning them
//   freeze(tree, precision)              see ControlSpaceBuilder::build
// and for sources that come after gradation:
//   release_asked(), keep_asked(metrics) see NodeMetrics; from the latter on, changes are recorded
//   is_regradable(), regrade(tree, past) whether changes are few and isotropic; grades those alone

/// One metric a leaf, constant over it (K_L, K_oL): a control node stands at the leaf's centre.
class LeafValues {
public:
    static constexpr bool exact_at_nodes = true;
    static constexpr int order = 0;
    static constexpr CutBy cut_by = CutBy::corners;
    static constexpr bool follows_neighbours = false;
    static constexpr bool grows_by_leaf = true;

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
        if (keeps_asked()) changes_.cut(subdivision.box, leaf, metrics_[leaf].xx);
        metrics_.repeat(leaf, static_cast<std::size_t>(subdivision.children() - 1));
    }

    void lower(const LeafPlace& place, const PointSource& source) {
        metrics_.lower(place.leaf, source.metric);
        if (keeps_asked()) changes_.lower(place);
    }

    /// Makes so many leaves more, whose metrics are then to be set.
    void grow(std::size_t leaves) { metrics_.grow(leaves); }
    std::span<Metric> metrics() { return metrics_.field(); }

    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const;

    template <class Node>
    std::size_t control_nodes_of(const Topology<Node>& tree) const {
        return tree.leaves();
    }
    template <class Node>
    void assign(const Topology<Node>& tree, std::span<const Metric> metrics) {
        metrics_.forget_asked();
        auto next = metrics.begin();
        tree.for_each_leaf([&](LeafIndex leaf, const Box&) { metrics_.set(leaf, *next++); });
    }

    template <class Node>
    GradationReport grade(const Topology<Node>& tree, const GradationOptions& options) {
        LeafGraph leaves = leaf_graph(tree, neighbourhood_of(options));
        metrics_.forget_asked();
        return controlspace::grade(std::move(leaves.graph), {metrics_.field(), leaves.order},
                                   options);
    }

    /// Sets the leaves to the field at their centres; where its bounds in them are known, they are
    /// to be set by those.
    template <class Node>
    void fit(const Topology<Node>&, std::span<const AdaptedLeaf> leaves, const GoalField& field,
             bool) {
        if (!field.has_ranges()) fit_to_centres(leaves, field);
    }
    void set(LeafIndex leaf, const Metric& m) { metrics_.set(leaf, m); }
    static constexpr bool is_fitted(LeafIndex) { return false; }
    static constexpr bool learn(LeafIndex, const Point&, const GoalField&) { return false; }

    template <class Node>
    std::unique_ptr<ControlSpace> freeze(const Topology<Node>& tree, Precision precision) const {
        return freeze_leaves(tree, metrics_.field(), precision);
    }

    bool keeps_asked() const { return metrics_.keeps_asked(); }
    std::vector<Metric> release_asked() { return metrics_.release_asked(); }
    void keep_asked(std::vector<Metric> asked) {
        metrics_.keep_asked(std::move(asked));
        changes_.begin(metrics_.size());
    }
    bool is_regradable() const {
        return metrics_.asks_isotropic() &&
               !are_many(changes_.count(metrics_.size()), metrics_.size());
    }
    template <class Node>
    GradationReport regrade(const Topology<Node>& tree, const PastGradation& past) {
        const GradationReport report = changes_.regrade(tree, metrics_, past);
        changes_.begin(metrics_.size());
        return report;
    }

    void save(StateWriter& state) const {
        NodeMetrics::exchange(metrics_, state);
        changes_.save(state);
    }
    template <class Node>
    void load(const Topology<Node>& tree, const StateReader& state) {
        NodeMetrics::exchange(metrics_, state);
        metrics_.require_sound(state, tree.leaves());
        changes_.load(state, tree.leaves());
    }

    void describe(Footprint& footprint) const { metrics_.describe(footprint); }
    void shrink_to_fit() { metrics_.shrink_to_fit(); }

protected:
    void fit_to_centres(std::span<const AdaptedLeaf> leaves, const GoalField& field) {
        in_parallel(leaves.size(), [&, memory = ConeField::Memory()](std::size_t i) mutable {
            const Point x = leaves[i].box.centre();
            Metric m;
            field.evaluate_here({&x, 1}, {&m, 1}, memory);
            metrics_.set(leaves[i].leaf, m);
        });
    }

    NodeMetrics metrics_;

private:
    LeafChanges changes_;
};

template <class Node>
ControlNodes LeafValues::control_nodes(const Topology<Node>& tree,
                                       Neighbourhood neighbourhood) const {
    LeafGraph leaves = leaf_graph(tree, neighbourhood);
    std::vector<Metric> metrics;
    metrics.reserve(leaves.order.size());
    for (const LeafIndex leaf : leaves.order) metrics.push_back(metrics_[leaf]);
    return {std::move(leaves.graph), std::move(metrics)};
}

}  // namespace controlspace
