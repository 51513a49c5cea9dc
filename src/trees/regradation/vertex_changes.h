#pragma once

#include <span>
#include <vector>

#include "controlspace/gradation/node_graph.h"
#include "gradation/regrade.h"
#include "space/state.h"
#include "trees/topology/corners.h"
#include "trees/topology/cut_leaves.h"
#include "trees/topology/leaves_where.h"
#include "trees/topology/topology.h"
#include "trees/values/node_metrics.h"

namespace controlspace {

/// What has happened to the leaves of a tree since it was graded, for metrics at their vertices;
/// and the gradation of that alone.
class VertexChanges {
public:
    void begin(std::size_t leaves, std::size_t vertices);
    /// The leaf is going to be cut; has been cut; has been lowered.
    template <class Storage>
    void before_split(const Storage& storage, const Subdivision&, LeafIndex leaf) {
        cut(leaf, storage.nodes_of(leaf));
    }
    template <class Storage>
    void after_split(const Storage& storage, const Subdivision& subdivision, LeafIndex leaf,
                     LeafIndex first_new) {
        touch(storage.nodes_of(leaf));
        for (int c = 1; c < subdivision.children(); ++c) touch(storage.nodes_of(first_new++));
    }
    template <class Storage>
    void lower(const Storage& storage, const LeafPlace& place) {
        touch(storage.nodes_of(place.leaf));
    }
    /// How many vertices are concerned.
    std::size_t count(std::size_t leaves);

    void save(StateWriter& state) const { exchange(*this, state); }
    void load(const StateReader& state, std::size_t, std::size_t vertices) {
        exchange(*this, state);
        require_below(state, "changes.cut_corners", cut_corners_, vertices);
        require_below(state, "changes.touched", touched_, vertices);
    }

    /// See Regradation; `past` is the gradation before. To be called after `count`.
    template <class Node, class Storage>
    GradationReport regrade(const Topology<Node>& tree, Storage& storage,
                            const PastGradation& past);

private:
    template <class Node>
    class Nodes;

    void cut(LeafIndex leaf, const Corners& corners);
    // They have been lowered, or been given new neighbours.
    void touch(const Corners& vertices) {
        touched_.insert(touched_.end(), vertices.begin(), vertices.end());
    }
    template <class Self, class State>
    static void exchange(Self& self, State& state) {
        CutLeaves::exchange(self.cut_, state);
        state("changes.vertices", self.vertices_);
        state("changes.cut_corners", self.cut_corners_);
        state("changes.touched", self.touched_);
    }

    CutLeaves cut_;
    std::size_t vertices_ = 0;
    std::vector<Corners> cut_corners_;
    std::vector<NodeIndex> touched_;  // with repetitions, until they are counted
};

/// Vertices as Regradation wants them.
template <class TreeNode>
class VertexChanges::Nodes {
public:
    using Node = NodeIndex;

    Nodes(const Topology<TreeNode>& tree, std::span<const Corners> corners,
          std::span<const Point> positions, NodeMetrics& metrics, Neighbourhood neighbourhood)
        : tree_(tree),
          corners_(corners),
          positions_(positions),
          metrics_(metrics),
          neighbourhood_(neighbourhood) {}

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
                for (std::size_t j = 0; j < 8; ++j) {
                    if (j == i || !are_neighbours(i, j, neighbourhood_)) continue;
                    visit(corners[j], way(node, corners[j]));
                }
            }
        });
    }

private:
    const Topology<TreeNode>& tree_;
    std::span<const Corners> corners_;
    std::span<const Point> positions_;
    NodeMetrics& metrics_;
    Neighbourhood neighbourhood_;
};

template <class Node, class Storage>
GradationReport VertexChanges::regrade(const Topology<Node>& tree, Storage& storage,
                                       const PastGradation& past) {
    const Neighbourhood neighbourhood = neighbourhood_of(past.options);
    Nodes<Node> nodes(tree, storage.corners(), storage.positions(), storage.metrics(),
                      neighbourhood);
    Regradation regradation(nodes, past.options.ratio);
    std::vector<NodeIndex> doubtful;
    const auto doubt = [&](NodeIndex held, NodeIndex by) {
        if (regradation.may_hang_on(held, nodes.field(by), nodes.way(by, held))) {
            doubtful.push_back(held);
        }
    };
    for (const Corners& cut : cut_corners_) {
        for_each_pair(cut, neighbourhood, [&](NodeIndex a, NodeIndex b) {
            doubt(a, b);
            doubt(b, a);
        });
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
