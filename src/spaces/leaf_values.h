#pragma once

#include <span>
#include <utility>
#include <vector>

#include "metric/blend.h"
#include "metric/intersection.h"
#include "spaces/adjacency.h"
#include "spaces/control_space.h"
#include "spaces/space_options.h"
#include "spaces/topology.h"

namespace controlspace {

// A storage says where the control nodes of a tree are and how the metric between them is made.
// What Tree asks of one:
//   value(tree, x)                       metric at x
//   split(subdivision, leaf, first_new)  a leaf was cut; the field stays as it was
//   lower(place, source)                 intersects what governs the leaf with the source
//   control_nodes(tree, neighbourhood), assign(tree, metrics), describe(footprint), shrink_to_fit()

/// One metric a leaf, constant over it (K_L, K_oL): a control node stands at the leaf's centre.
class LeafValues {
public:
    static constexpr bool exact_at_nodes = true;
    static constexpr int order = 0;

    explicit LeafValues(const SpaceOptions& options) : metrics_{largest_metric(options.domain)} {}

    template <class Node>
    Metric value(const Topology<Node>& tree, const Point& x) const {
        return metrics_[tree.find(x)];
    }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) {
        const Metric inherited = metrics_[leaf];
        metrics_.insert(metrics_.end(), static_cast<std::size_t>(subdivision.children() - 1),
                        inherited);
    }

    void lower(const LeafPlace& place, const PointSource& source) {
        metrics_[place.leaf] = intersection(metrics_[place.leaf], source.metric);
    }

    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const;

    template <class Node>
    void assign(const Topology<Node>& tree, std::span<const Metric> metrics) {
        auto next = metrics.begin();
        tree.for_each_leaf([&](LeafIndex leaf, const Box&) { metrics_[leaf] = *next++; });
    }

    void describe(Footprint& footprint) const {
        footprint.control_nodes = metrics_.size();
        footprint.bytes_payload = metrics_.capacity() * sizeof(Metric);
    }
    void shrink_to_fit() { metrics_.shrink_to_fit(); }

protected:
    std::vector<Metric> metrics_;
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
