#pragma once

#include "controlspace/geometry/box.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// Calls visit(leaf, box) for the leaves whose box, and all boxes above it, `keep(box)` accepts:
/// neighbours on demand, in time that grows with the depth and not with the number of leaves.
template <class Node, class Keep, class Visit>
class LeavesWhere {
public:
    LeavesWhere(const Topology<Node>& tree, const Keep& keep, Visit& visit)
        : tree_(tree), keep_(keep), visit_(visit) {
        look_into(tree.root(), tree.domain());
    }

private:
    void look_into(Ref ref, const Box& box) {
        if (!keep_(box)) return;
        if (ref.is_leaf()) {
            visit_(LeafIndex{ref.index()}, box);
            return;
        }
        const Node& inner = tree_.node(ref);
        const Subdivision subdivision = inner.subdivision(box);
        for (int c = 0; c < Topology<Node>::arity; ++c) {
            look_into(inner.children[static_cast<std::size_t>(c)], subdivision.child(c));
        }
    }

    const Topology<Node>& tree_;
    const Keep& keep_;
    Visit& visit_;
};

/// Leaves that touch the place `x`.
template <class Node, class Visit>
void for_each_leaf_at(const Topology<Node>& tree, const Point& x, Visit&& visit) {
    const auto keep = [&](const Box& box) { return box.contains(x); };
    LeavesWhere(tree, keep, visit);
}

/// Leaves that overlap `box` or share a part of a face with it that has an area; with the
/// neighbourhood `all`, also those that touch it elsewhere.
template <class Node, class Visit>
void for_each_leaf_around(const Topology<Node>& tree, const Box& box, Neighbourhood neighbourhood,
                          Visit&& visit) {
    const int least = neighbourhood == Neighbourhood::all ? 0 : 2;
    const auto keep = [&](const Box& other) {
        int overlaps = 0;
        for (Axis a = 0; a < 3; ++a) {
            if (other.low[a] > box.high[a] || other.high[a] < box.low[a]) return false;
            overlaps += other.low[a] < box.high[a] && other.high[a] > box.low[a] ? 1 : 0;
        }
        return overlaps >= least;
    };
    LeavesWhere(tree, keep, visit);
}

}  // namespace controlspace
