#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "gradation/node_graph.h"
#include "gradation/regrade.h"
#include "spaces/cut_leaves.h"
#include "spaces/leaves_where.h"
#include "spaces/node_metrics.h"
#include "spaces/topology.h"

namespace controlspace {

/// Control nodes at the eight vertices of a leaf, in the order of controlspace::corner.
using Corners = std::array<NodeIndex, 8>;

/// visit(a, b) for the twelve edges of a leaf.
template <class Visit>
void for_each_edge(const Corners& corners, Visit&& visit) {
    for (std::size_t i = 0; i < 8; ++i) {
        for (const std::size_t bit : {1u, 2u, 4u}) {
            if ((i & bit) == 0) visit(corners[i], corners[i | bit]);
        }
    }
}

/// What has happened to the leaves of a tree since it was graded, for metrics at their vertices;
/// and the gradation of that alone.
class VertexChanges {
public:
    void begin(std::size_t leaves, std::size_t vertices);
    /// The leaf with these corners is going to be cut.
    void cut(LeafIndex leaf, const Corners& corners);
    /// The vertex has been lowered, or been given new neighbours.
    void touch(NodeIndex vertex) { touched_.push_back(vertex); }
    /// How many vertices are concerned.
    std::size_t count();

    /// See Regradation; `past` is the gradation before. To be called after `count`.
    template <class Node>
    GradationReport regrade(const Topology<Node>& tree, std::span<const Corners> corners,
                            std::span<const Point> positions, NodeMetrics& metrics,
                            const PastGradation& past);

private:
    template <class Node>
    class Nodes;

    CutLeaves cut_;
    std::size_t vertices_ = 0;
    std::vector<std::pair<NodeIndex, NodeIndex>> lost_links_;
    std::vector<NodeIndex> touched_;  // with repetitions, until they are counted
};

/// Vertices as Regradation wants them.
template <class TreeNode>
class VertexChanges::Nodes {
public:
    using Node = NodeIndex;

    Nodes(const Topology<TreeNode>& tree, std::span<const Corners> corners,
          std::span<const Point> positions, NodeMetrics& metrics)
        : tree_(tree), corners_(corners), positions_(positions), metrics_(metrics) {}

    double asked(NodeIndex node) const { return metrics_.asked()[node].xx; }
    double field(NodeIndex node) const { return metrics_[node].xx; }
    void set(NodeIndex node, double h) { metrics_.set(node, Metric::isotropic(h)); }
    Vector way(NodeIndex from, NodeIndex to) const { return positions_[to] - positions_[from]; }

    /// Neighbours that share several leaves with the node come as often.
    template <class Visit>
    void for_each_link(NodeIndex node, Visit&& visit) const {
        for_each_leaf_at(tree_, positions_[node], [&](LeafIndex leaf, const Box&) {
            const Corners& corners = corners_[leaf];
            for (std::size_t i = 0; i < 8; ++i) {
                if (corners[i] != node) continue;
                for (const std::size_t bit : {1u, 2u, 4u}) {
                    visit(corners[i ^ bit], way(node, corners[i ^ bit]));
                }
            }
        });
    }

private:
    const Topology<TreeNode>& tree_;
    std::span<const Corners> corners_;
    std::span<const Point> positions_;
    NodeMetrics& metrics_;
};

template <class Node>
GradationReport VertexChanges::regrade(const Topology<Node>& tree, std::span<const Corners> corners,
                                       std::span<const Point> positions, NodeMetrics& metrics,
                                       const PastGradation& past) {
    Nodes<Node> nodes(tree, corners, positions, metrics);
    Regradation regradation(nodes, past.options.ratio);
    std::vector<NodeIndex> doubtful;
    const auto doubt = [&](NodeIndex held, NodeIndex by) {
        if (regradation.may_hang_on(held, nodes.field(by), nodes.way(by, held))) {
            doubtful.push_back(held);
        }
    };
    for (const auto& [a, b] : lost_links_) {
        doubt(a, b);
        doubt(b, a);
    }
    for (const NodeIndex node : touched_) {
        if (node >= vertices_)
            regradation.renew(node);
        else
            regradation.touch(node);
    }
    for (const NodeIndex node : doubtful) regradation.release(node);
    return regradation.run(past.largest_ratio_left);
}

}  // namespace controlspace
