#pragma once

#include <span>
#include <utility>
#include <vector>

#include "gradation/grade.h"
#include "gradation/queue.h"
#include "spaces/adjacency.h"
#include "spaces/anchors.h"
#include "spaces/control_space.h"
#include "spaces/source_table.h"
#include "spaces/space_options.h"
#include "spaces/topology.h"

namespace controlspace {

/// The sources that govern a leaf in place of a metric (K_LA, K_oLA): a query evaluates their cones
/// at the very place. So the field varies inside a leaf, and distances are straight lines, where
/// values handed from leaf to leaf add up along a path.
///
/// Gradation hands on sources: each leaf tries those of its face neighbours and keeps the three
/// that make its field smallest, until no leaf gains. The law is the cone law whatever is asked,
/// since that is what a cone is.
class AnchoredValues {
public:
    static constexpr bool exact_at_nodes = true;
    static constexpr int order = 0;

    explicit AnchoredValues(const SpaceOptions& options);

    template <class Node>
    Metric value(const Topology<Node>& tree, const Point& place) const {
        const Point x = place.cwiseMax(tree.domain().low).cwiseMin(tree.domain().high);
        return cones().at(x, anchors_[tree.find(x)].span());
    }
    template <class Node>
    Metric asked(const Topology<Node>& tree, const Point& place) const {
        return value(tree, place);
    }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new);

    /// The source becomes an anchor of its leaf. Where three stand there already, the one that is
    /// missed least gives way; if it would be missed by the insertion tolerance at its own place,
    /// the newcomer takes the intersection of both metrics.
    void lower(const LeafPlace& place, const PointSource& source);

    /// Leaf centres with the field there.
    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const;

    /// Of isotropic sources: leaves that neighbours' sources would serve better at a corner, by δ >
    /// 0.02, are cut on the way, unless they are as short as l_min in their own metric or as deep
    /// as `max_depth`.
    template <class Node>
    GradationReport grade(Topology<Node>& tree, const GradationOptions& options, int max_depth);

    void describe(Footprint& footprint) const;
    void shrink_to_fit();

private:
    ConeIntersection<Metric> cones() const { return {sources_, ratio_, largest_}; }
    ConeIntersection<double> isotropic_cones() const { return {sources_, ratio_, largest_.xx}; }
    /// Hands on anchors from the nodes in `queue` until no leaf gains; returns the gains. Then, in
    /// `badly_served`, the leaves that sources of their neighbours would still serve better.
    template <class Size>
    std::uint64_t spread(const ConeIntersection<Size>& field, const LeafGraph& leaves,
                         std::span<const Box> boxes, NodeQueue queue,
                         std::vector<NodeIndex>& badly_served);
    template <class Size>
    bool is_well_served(const ConeIntersection<Size>& field, const LeafGraph& leaves,
                        NodeIndex node, const Box& box) const;
    void drop_idle_sources();
    std::vector<Metric> metrics_at_centres(const LeafGraph& leaves) const;

    std::vector<Anchors> anchors_;  // of a leaf
    SourceTable sources_;
    Metric largest_;
    double ratio_;
    double tolerance_;
    double l_min_;
};

template <class Node>
ControlNodes AnchoredValues::control_nodes(const Topology<Node>& tree,
                                           Neighbourhood neighbourhood) const {
    LeafGraph leaves = leaf_graph(tree, neighbourhood);
    std::vector<Metric> metrics = metrics_at_centres(leaves);
    return {std::move(leaves.graph), std::move(metrics)};
}

template <class Node>
GradationReport AnchoredValues::grade(Topology<Node>& tree, const GradationOptions& options,
                                      int max_depth) {
    require_valid(options);
    ratio_ = options.ratio;
    GradationReport report;
    std::vector<std::uint8_t> fresh(tree.leaves(), 1);  // leaves that have not tried any source
    for (;;) {
        const LeafGraph leaves = leaf_graph(tree, Neighbourhood::faces);
        std::vector<Box> boxes;
        boxes.reserve(tree.leaves());
        tree.for_each_leaf([&](LeafIndex, const Box& box) { boxes.push_back(box); });

        std::vector<NodeIndex> first;
        for (NodeIndex i = 0; i < leaves.order.size(); ++i) {
            if (fresh[leaves.order[i]] != 0) {
                first.push_back(i);
                leaves.graph.for_each_neighbour(i, [&](NodeIndex j) { first.push_back(j); });
            }
        }
        std::vector<NodeIndex> badly_served;
        NodeQueue queue(leaves.order.size(), first);
        report.operations +=
            sources_.all_isotropic()
                ? spread(isotropic_cones(), leaves, boxes, std::move(queue), badly_served)
                : spread(cones(), leaves, boxes, std::move(queue), badly_served);

        fresh.assign(tree.leaves(), 0);
        for (const NodeIndex i : badly_served) {
            const LeafPlace place = tree.locate(boxes[i].centre());
            const Subdivision subdivision = Node::even_subdivision(place.box);
            if (place.level >= max_depth || !subdivision.is_proper()) continue;
            const auto first_new = static_cast<LeafIndex>(tree.leaves());
            tree.split(place, subdivision);
            split(subdivision, place.leaf, first_new);
            fresh[place.leaf] = 1;
            fresh.resize(tree.leaves(), 1);
        }
        if (fresh.end() == std::find(fresh.begin(), fresh.end(), 1)) {
            report.largest_ratio_left =
                largest_gradation(leaves.graph, metrics_at_centres(leaves), GradationLaw::cone);
            break;
        }
    }
    drop_idle_sources();
    tree.shrink_to_fit();
    shrink_to_fit();
    return report;
}

}  // namespace controlspace
