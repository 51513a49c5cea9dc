// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trees/topology/topology.h"

namespace controlspace {

/// Calls visit(low leaf, high leaf) for pairs of leaves that share a part of a face with an area:
/// each pair once, the leaf on the low side of the face first.
template <class Node, class Visit>
class FacePairs {
public:
    FacePairs(const Topology<Node>& tree, Visit& visit) : tree_(tree), visit_(visit) {}

    /// All pairs inside one part of the tree.
    void within(const TreePart& part) {
        if (part.ref.is_leaf()) return;
        tree_.for_each_child(part, [&](const TreePart& child) { within(child); });
        between_children(part);
    }

    /// Those whose leaves lie in different children of an inner node.
    void between_children(const TreePart& part) {
        if constexpr (Node::is_octant) {
            for (Axis a = 0; a < 3; ++a) across_octants(part.ref, part.ref, a, true);
        } else {
            TreePart low = tree_.child(part, 0);
            TreePart high = tree_.child(part, 1);
            across(low, high, tree_.node(part.ref).axis());
        }
    }

private:
    // All pairs across the plane with normal `a` that has `low` on one side and `high` on the
    // other; their cross-sections share an area. Both parts are as before afterwards.
    void across(TreePart& low, TreePart& high, Axis a) {
        if (!low.ref.is_leaf()) {
            descend(low, high.box, a, 1, [&] { across(low, high, a); });
        } else if (!high.ref.is_leaf()) {
            descend(high, low.box, a, 0, [&] { across(low, high, a); });
        } else {
            visit_(LeafIndex{low.ref.index()}, LeafIndex{high.ref.index()});
        }
    }

    // Calls visit() with `part` set to each of its children that touches the plane, on its side
    // `side`, and shares an area with `opposite` there.
    template <class VisitChild>
    void descend(TreePart& part, const Box& opposite, Axis a, int side, VisitChild&& visit_child) {
        const KdNode& node = tree_.node(part.ref);
        const Axis cut = node.axis();
        const Ref whole = part.ref;
        const auto enter = [&](std::size_t c) {
            double& end = (c == 1 ? part.box.low : part.box.high)[cut];
            const double old = end;
            end = node.at;
            part.ref = node.children[c];
            visit_child();
            end = old;
        };
        if (cut == a) {
            enter(static_cast<std::size_t>(side));
        } else {
            if (opposite.low[cut] < node.at) enter(0);
            if (node.at < opposite.high[cut]) enter(1);
        }
        part.ref = whole;
    }

    // The same for octants: cross-sections are the same, or a leaf's holds the other, so boxes need
    // not be compared, and inner nodes are of one level, so that they cut the same axes. `low` and
    // `high` may be one node whose children are meant.
    void across_octants(Ref low, Ref high, Axis a, bool siblings = false) {
        const bool low_ends = low.is_leaf();
        const bool high_ends = high.is_leaf();
        if (low_ends && high_ends) {
            visit_(LeafIndex{low.index()}, LeafIndex{high.index()});
            return;
        }
        const unsigned axes = tree_.node(low_ends ? high : low).axes();
        const unsigned side = axes & 1u << a;
        if (siblings && side == 0) return;
        for (unsigned c = 0; c < 8; ++c) {
            if ((c & side) != 0 || (c & ~axes) != 0) continue;
            // Towards the plane: the low part's high side, and the high part's low side.
            const unsigned of_low = siblings ? c : c | side;
            const unsigned of_high = siblings ? c | side : c;
            across_octants(low_ends ? low : tree_.node(low).children[of_low],
                           high_ends ? high : tree_.node(high).children[of_high], a);
        }
    }

    const Topology<Node>& tree_;
    Visit& visit_;
};

}  // namespace controlspace
