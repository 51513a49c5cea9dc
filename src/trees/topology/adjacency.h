// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/gradation/node_graph.h"
#include "geometry/large_pages.h"
#include "trees/topology/corners.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Moves `x` across face `face` of a leaf with this box, to where the leaf that touches the face
/// opposite to `x` holds it (the low side on ties). Faces: 2 axis for the low face, 2 axis + 1 for
/// the high one. False, and nothing moves, at the domain's border.
inline bool step_across(const Box& domain, const Box& box, int face, Point& x) {
    const Axis a = face / 2;
    const bool high = face % 2 == 1;
    if (high ? box.high[a] >= domain.high[a] : box.low[a] <= domain.low[a]) return false;
    // A place on a plane belongs to the low side: the next number above is on the high side.
    x[a] = high ? std::nextafter(box.high[a], std::numeric_limits<double>::infinity()) : box.low[a];
    return true;
}

/// The leaf on the other side (see step_across); false at the domain's border.
template <class Node>
bool locate_across(const Topology<Node>& tree, const Box& box, int face, Point x,
                   LeafPlace& place) {
    if (!step_across(tree.domain(), box, face, x)) return false;
    place = tree.locate(x);
    return true;
}

/// Sets the rows of neighbours of `graph`, which has so many nodes. `for_each_link(enter)` has to
/// call enter(node, neighbour) for all links, in both directions, and is called twice: to count
/// them, and to fill the rows in the order of the calls. It may use many threads, if at any time
/// one alone enters a node's neighbours.
template <class ForEachLink>
void link(NodeGraph& graph, std::size_t nodes, ForEachLink&& for_each_link) {
    // Rows are counted two places on, and filled from one place on: that place then is where the
    // row ends and the next begins.
    graph.first = large_array<std::size_t>(nodes + 2);
    for_each_link([&](NodeIndex node, NodeIndex) { ++graph.first[std::size_t{node} + 2]; });
    std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
    graph.neighbours = large_array<NodeIndex>(graph.first.back());
    for_each_link([&](NodeIndex node, NodeIndex neighbour) {
        graph.neighbours[graph.first[std::size_t{node} + 1]++] = neighbour;
    });
    graph.first.pop_back();
}

/// The same for undirected links.
void link_pairs(NodeGraph& graph, std::size_t nodes,
                std::span<const std::pair<NodeIndex, NodeIndex>> pairs);

/// Removes repeated neighbours and sorts each row.
void sort_rows_uniquely(NodeGraph& graph);

/// Where so many vertices stand, of which `corners` are those of the leaves.
template <class Node>
std::vector<Point> vertex_positions(const Topology<Node>& tree, std::span<const Corners> corners,
                                    std::size_t count) {
    std::vector<Point> positions(count, tree.domain().low);
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
        for (int i = 0; i < 8; ++i) {
            positions[corners[leaf][static_cast<std::size_t>(i)]] = corner(box, i);
        }
    });
    return positions;
}

/// The vertices of leaves as a graph.
NodeGraph vertex_graph(std::span<const Corners> leaves, std::vector<Point> positions,
                       Neighbourhood neighbourhood);

}  // namespace controlspace
