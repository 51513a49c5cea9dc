// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "trees/topology/corners.h"
#include "trees/topology/cut_lattice.h"
#include "trees/topology/place_index.h"
#include "trees/topology/topology.h"
#include "trees/topology/work_through.h"

namespace controlspace {

/// The vertices of the leaves of a tree: one for each place where a leaf has a corner, in the order
/// of the inner nodes that made them.
struct LeafVertices {
    std::vector<Corners> of_leaves;
    std::vector<Point> positions;
};

/// On all of TBB's threads.
template <class Node>
LeafVertices leaf_vertices(const Topology<Node>& tree) {
    // Each inner node has room for the places that its cut may make; those that several make are
    // found to be one afterwards.
    constexpr std::size_t most =
        Node::arity == 2 ? CutLattice::most_new_of_one : CutLattice::most_new;
    std::vector<Point> x = large_array<Point>(8 + most * tree.inner_nodes());
    struct Item {
        TreePart part;
        Corners corners;
    };
    Item whole{{tree.root(), tree.domain()}, {}};
    for (int i = 0; i < 8; ++i) {
        const auto c = static_cast<std::size_t>(i);
        x[c] = corner(tree.domain(), i);
        whole.corners[c] = static_cast<NodeIndex>(i);
    }
    LeafVertices found;
    found.of_leaves = large_array<Corners>(tree.leaves());
    work_through(whole, [&](const Item& item, const auto& next) {
        if (item.part.ref.is_leaf()) {
            found.of_leaves[item.part.ref.index()] = item.corners;
            return;
        }
        const Node& node = tree.node(item.part.ref);
        const Subdivision subdivision = node.subdivision(item.part.box);
        CutLattice lattice(subdivision, item.corners);
        std::size_t number = 8 + most * item.part.ref.index();
        const std::size_t end = number + most;
        for (const CutLattice::Place& place : lattice.new_places()) {
            x[number] = place.x;
            lattice.set(place, static_cast<NodeIndex>(number++));
        }
        for (; number < end; ++number) x[number].x() = std::numeric_limits<double>::quiet_NaN();
        for (int c = 0; c < node.count(); ++c) {
            next({{node.children[node.slot(c)], subdivision.child(c)}, lattice.child(c)});
        }
    });
    const std::vector<NodeIndex> number = number_places(x, found.positions);
    tbb::parallel_for(std::size_t{0}, found.of_leaves.size(), [&](std::size_t leaf) {
        for (NodeIndex& vertex : found.of_leaves[leaf]) vertex = number[vertex];
    });
    return found;
}

}  // namespace controlspace
