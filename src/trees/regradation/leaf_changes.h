#pragma once

#include <utility>
#include <vector>

#include "gradation/regrade.h"
#include "space/state.h"
#include "trees/topology/cut_leaves.h"
#include "trees/topology/leaves_where.h"
#include "trees/topology/topology.h"
#include "trees/values/node_metrics.h"

namespace controlspace {

/// What has happened to the leaves of a tree since it was graded, for metrics at leaf centres; and
/// the gradation of that alone.
class LeafChanges {
public:
    void begin(std::size_t leaves, std::size_t nodes);
    /// The leaf is going to be cut; has been cut; has been lowered.
    template <class Storage>
    void before_split(const Storage& storage, const Subdivision& subdivision, LeafIndex leaf) {
        cut(subdivision.box, leaf, storage.metrics()[leaf].xx);
    }
    template <class Storage>
    static void after_split(const Storage&, const Subdivision&, LeafIndex, LeafIndex) {}
    template <class Storage>
    void lower(const Storage&, const LeafPlace& place) {
        if (cut_.is_old(place.leaf)) lowered_.push_back({place.leaf, place.box});
    }
    /// How many of so many leaves are concerned.
    std::size_t count(std::size_t leaves) const { return lowered_.size() + cut_.made(leaves); }

    void save(StateWriter& state) const;
    /// What was saved of a tree of so many leaves.
    void load(const StateReader& state, std::size_t leaves, std::size_t nodes);

    /// See Regradation; `past` is the gradation before.
    template <class Node, class Storage>
    GradationReport regrade(const Topology<Node>& tree, Storage& storage,
                            const PastGradation& past) const;

private:
    struct Leaf {
        LeafIndex leaf;
        Box box;
    };
    struct Cut {
        Box box;
        double held;
    };
    template <class Node>
    class Nodes;

    // The leaf `box`, whose field is `held`, is going to be cut.
    void cut(const Box& box, LeafIndex leaf, double held);

    CutLeaves cut_;
    std::vector<Cut> cuts_;  // the same, with what they were
    std::vector<Leaf> lowered_;
};

/// Leaves as Regradation wants them.
template <class TreeNode>
class LeafChanges::Nodes {
public:
    using Node = Leaf;

    Nodes(const Topology<TreeNode>& tree, NodeMetrics& metrics, Neighbourhood neighbourhood)
        : tree_(tree), metrics_(metrics), neighbourhood_(neighbourhood) {}

    double asked(const Leaf& node) const { return metrics_.asked()[node.leaf].xx; }
    double field(const Leaf& node) const { return metrics_[node.leaf].xx; }
    void set(const Leaf& node, double h) { metrics_.set(node.leaf, Metric::isotropic(h)); }

    template <class Visit>
    void for_each_link(const Leaf& node, Visit&& visit) const {
        const Point centre = node.box.centre();
        for_each_around(node.box, [&](const Leaf& other) {
            if (other.leaf != node.leaf) visit(other, Vector(other.box.centre() - centre));
        });
    }
    /// visit(leaf) for those in the box, and their neighbours.
    template <class Visit>
    void for_each_around(const Box& box, Visit&& visit) const {
        for_each_leaf_around(tree_, box, neighbourhood_, [&](LeafIndex leaf, const Box& own) {
            visit(Leaf{leaf, own});
        });
    }

private:
    const Topology<TreeNode>& tree_;
    NodeMetrics& metrics_;
    Neighbourhood neighbourhood_;
};

template <class Node, class Storage>
GradationReport LeafChanges::regrade(const Topology<Node>& tree, Storage& storage,
                                     const PastGradation& past) const {
    Nodes<Node> nodes(tree, storage.metrics(), neighbourhood_of(past.options));
    Regradation regradation(nodes, past.options.ratio);
    std::vector<Leaf> doubtful;
    for (const Cut& cut : cuts_) {
        const Point centre = cut.box.centre();
        nodes.for_each_around(cut.box, [&](const Leaf& node) {
            const Point x = node.box.centre();
            if (cut.box.contains(x)) {
                regradation.renew(node);
            } else if (regradation.may_hang_on(node, cut.held, Vector(x - centre))) {
                doubtful.push_back(node);
            }
        });
    }
    for (const Leaf& node : doubtful) regradation.release(node);
    for (const Leaf& node : lowered_) {
        if (cut_.is_old(node.leaf)) regradation.touch(node);
    }
    return regradation.run(past.largest_ratio_left);
}

}  // namespace controlspace
