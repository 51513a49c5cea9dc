// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/geometry/box.h"
#include "controlspace/gradation/node_graph.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Calls visit(leaf, box) for the leaves below `part` whose box, and all boxes above it,
/// `keep(box)` accepts: neighbours on demand, in time that grows with the depth and not with the
/// number of leaves.
template <class Node, class Keep, class Visit>
void for_each_leaf_where(const Topology<Node>& tree, const TreePart& part, const Keep& keep,
                         Visit&& visit) {
    if (!keep(part.box)) return;
    if (part.ref.is_leaf()) {
        visit(LeafIndex{part.ref.index()}, part.box);
        return;
    }
    tree.for_each_child(
        part, [&](const TreePart& child) { for_each_leaf_where(tree, child, keep, visit); });
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
            const bool is_flat = box.low[a] == box.high[a];
            overlaps += is_flat || (other.low[a] < box.high[a] && other.high[a] > box.low[a]);
        }
        return overlaps >= least;
    };
    for_each_leaf_where(tree, {tree.root(), tree.domain()}, keep, visit);
}

}  // namespace controlspace
