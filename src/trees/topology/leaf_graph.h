// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <numeric>
#include <utility>
#include <vector>

#include "controlspace/gradation/node_graph.h"
#include "geometry/large_pages.h"
#include "trees/topology/adjacency.h"
#include "trees/topology/face_pairs.h"
#include "trees/topology/topology.h"
#include "trees/topology/touching_pairs.h"

namespace controlspace {

/// The leaves of a tree as a graph: nodes at their centres, in depth-first order.
struct LeafGraph {
    NodeGraph graph;
    std::vector<LeafIndex> order;  ///< the leaf of each node
};

/// A tree as parts that can be worked upon at the same time, and the inner nodes above them. The
/// parts are a matter of the tree alone, not of the number of threads.
struct TreeParts {
    std::vector<TreePart> parts;               ///< in depth-first order
    std::vector<std::vector<TreePart>> above;  ///< by level, the root's first
};

/// Inner nodes of level `level` enter `above`, as long as that has such a level.
template <class Node>
void add_parts(const Topology<Node>& tree, const TreePart& part, std::size_t level,
               TreeParts& all) {
    if (level == all.above.size() || part.ref.is_leaf()) {
        all.parts.push_back(part);
        return;
    }
    all.above[level].push_back(part);
    tree.for_each_child(part,
                        [&](const TreePart& child) { add_parts(tree, child, level + 1, all); });
}

/// At most 512 parts: cuts three times along each axis, or as often as that in all.
template <class Node>
TreeParts parts_of(const Topology<Node>& tree) {
    TreeParts all;
    all.above.resize(Node::is_octant ? 3 : 9);
    add_parts(tree, {tree.root(), tree.domain()}, 0, all);
    return all;
}

/// Leaves in depth-first order, and their centres.
template <class Node>
void number_leaves(const Topology<Node>& tree, const TreeParts& all, LeafGraph& leaves) {
    std::vector<std::size_t> first(all.parts.size() + 1, 0);
    const auto each_part = [&](auto&& work) {
        tbb::parallel_for(std::size_t{0}, all.parts.size(), work);
    };
    each_part([&](std::size_t p) {
        std::size_t count = 0;
        tree.for_each_leaf_in(all.parts[p], [&](LeafIndex, const Box&) { ++count; });
        first[p + 1] = count;
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    leaves.order = large_array<LeafIndex>(first.back());
    leaves.graph.positions = large_array<Point>(first.back());
    each_part([&](std::size_t p) {
        std::size_t next = first[p];
        tree.for_each_leaf_in(all.parts[p], [&](LeafIndex leaf, const Box& box) {
            leaves.order[next] = leaf;
            leaves.graph.positions[next++] = box.centre();
        });
    });
}

/// Calls visit(leaf, leaf) for all pairs across faces, on all of TBB's threads. Parts have no
/// leaves in common, nor have inner nodes of one level above them, so all of them at the same time,
/// and then what lies between the children of inner nodes, level after level, visit the pairs of
/// each leaf in the order of one walk through the whole tree, one at a time.
template <class Node, class Visit>
void for_each_face_pair(const Topology<Node>& tree, const TreeParts& all, const Visit& visit) {
    tbb::parallel_for(std::size_t{0}, all.parts.size(), [&](std::size_t p) {
        FacePairs<Node, const Visit>(tree, visit).within(all.parts[p]);
    });
    for (auto level = all.above.rbegin(); level != all.above.rend(); ++level) {
        tbb::parallel_for(std::size_t{0}, level->size(), [&](std::size_t i) {
            FacePairs<Node, const Visit>(tree, visit).between_children((*level)[i]);
        });
    }
}

template <class Node>
LeafGraph leaf_graph(const Topology<Node>& tree, Neighbourhood neighbourhood) {
    const TreeParts all = parts_of(tree);
    LeafGraph leaves;
    number_leaves(tree, all, leaves);
    std::vector<NodeIndex> rank = large_array<NodeIndex>(tree.leaves());
    for (std::size_t i = 0; i < rank.size(); ++i) rank[leaves.order[i]] = static_cast<NodeIndex>(i);

    NodeGraph& graph = leaves.graph;
    if (neighbourhood == Neighbourhood::faces) {
        link(graph, rank.size(), [&](const auto& enter) {
            for_each_face_pair(tree, all, [&](LeafIndex a, LeafIndex b) {
                enter(rank[a], rank[b]);
                enter(rank[b], rank[a]);
            });
        });
    } else if (neighbourhood == Neighbourhood::all) {
        std::vector<std::pair<NodeIndex, NodeIndex>> pairs;
        for_each_touching_pair(
            tree, [&](LeafIndex a, LeafIndex b) { pairs.emplace_back(rank[a], rank[b]); });
        link_pairs(graph, rank.size(), pairs);
    } else {
        graph.first.reserve(rank.size() + 1);
        graph.first.push_back(0);
        tree.for_each_leaf([&](LeafIndex, const Box& box) {
            LeafPlace across;
            for (int face = 0; face < 6; ++face) {
                if (locate_across(tree, box, face, box.centre(), across)) {
                    graph.neighbours.push_back(rank[across.leaf]);
                }
            }
            graph.first.push_back(graph.neighbours.size());
        });
    }
    return leaves;
}

}  // namespace controlspace
