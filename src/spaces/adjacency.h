#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "gradation/node_graph.h"
#include "spaces/corners.h"
#include "spaces/topology.h"
#include "spaces/touching_pairs.h"

namespace controlspace {

/// Calls visit(low leaf, high leaf) for every pair of leaves that share a part of a face with an
/// area: each pair once, the leaf on the low side of the face first.
template <class Node, class Visit>
class FacePairs {
public:
    FacePairs(const Topology<Node>& tree, Visit& visit) : tree_(tree), visit_(visit) {
        within(Cell{tree.root(), tree.domain()});
    }

private:
    struct Cell {
        Ref ref;
        Box box;
    };
    static constexpr int arity = Topology<Node>::arity;

    Cell child(const Node& node, const Subdivision& subdivision, int c) const {
        return {node.children[static_cast<std::size_t>(c)], subdivision.child(c)};
    }

    // All pairs inside one cell.
    void within(const Cell& cell) {
        if (cell.ref.is_leaf()) return;
        const Node& node = tree_.node(cell.ref);
        const Subdivision subdivision = node.subdivision(cell.box);
        for (int c = 0; c < arity; ++c) within(child(node, subdivision, c));
        int bit = 0;
        for (Axis a = 0; a < 3; ++a) {
            if (!subdivision.cuts[static_cast<std::size_t>(a)]) continue;
            for (int c = 0; c < arity; ++c) {
                if ((c >> bit & 1) != 0) continue;
                across(child(node, subdivision, c), child(node, subdivision, c | 1 << bit), a);
            }
            ++bit;
        }
    }

    // All pairs across the plane with normal `a` that has `low` on one side and `high` on the
    // other; their cross-sections overlap.
    void across(const Cell& low, const Cell& high, Axis a) {
        if (!low.ref.is_leaf()) {
            const Node& node = tree_.node(low.ref);
            const Subdivision subdivision = node.subdivision(low.box);
            for (int c = 0; c < arity; ++c) {
                const Cell part = child(node, subdivision, c);
                if (part.box.high[a] == low.box.high[a] && overlap(part.box, high.box, a)) {
                    across(part, high, a);
                }
            }
        } else if (!high.ref.is_leaf()) {
            const Node& node = tree_.node(high.ref);
            const Subdivision subdivision = node.subdivision(high.box);
            for (int c = 0; c < arity; ++c) {
                const Cell part = child(node, subdivision, c);
                if (part.box.low[a] == high.box.low[a] && overlap(low.box, part.box, a)) {
                    across(low, part, a);
                }
            }
        } else {
            visit_(low.ref.index(), high.ref.index());
        }
    }

    // Whether the cross-sections perpendicular to `normal` share an area.
    static bool overlap(const Box& p, const Box& q, Axis normal) {
        for (Axis a = 0; a < 3; ++a) {
            if (a != normal && !(p.low[a] < q.high[a] && q.low[a] < p.high[a])) return false;
        }
        return true;
    }

    const Topology<Node>& tree_;
    Visit& visit_;
};

template <class Node, class Visit>
void for_each_face_pair(const Topology<Node>& tree, Visit&& visit) {
    FacePairs<Node, Visit>(tree, visit);
}

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

/// Undirected links in no particular order, as rows of neighbours; `positions` stays empty.
NodeGraph graph_from_pairs(std::size_t nodes,
                           std::span<const std::pair<NodeIndex, NodeIndex>> pairs);

/// Removes repeated neighbours and sorts each row.
void sort_rows_uniquely(NodeGraph& graph);

/// The vertices of leaves as a graph.
NodeGraph vertex_graph(std::span<const Corners> leaves, std::vector<Point> positions,
                       Neighbourhood neighbourhood);

/// The leaves of a tree as a graph: nodes at their centres, in depth-first order.
struct LeafGraph {
    NodeGraph graph;
    std::vector<LeafIndex> order;  ///< the leaf of each node
};

template <class Node>
LeafGraph leaf_graph(const Topology<Node>& tree, Neighbourhood neighbourhood) {
    LeafGraph leaves;
    std::vector<NodeIndex> rank(tree.leaves());
    std::vector<Point> centres;
    leaves.order.reserve(tree.leaves());
    centres.reserve(tree.leaves());
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
        rank[leaf] = static_cast<NodeIndex>(leaves.order.size());
        leaves.order.push_back(leaf);
        centres.push_back(box.centre());
    });

    NodeGraph& graph = leaves.graph;
    if (neighbourhood != Neighbourhood::nearest_per_face) {
        std::vector<std::pair<NodeIndex, NodeIndex>> pairs;
        const auto enter = [&](LeafIndex a, LeafIndex b) { pairs.emplace_back(rank[a], rank[b]); };
        if (neighbourhood == Neighbourhood::faces) {
            pairs.reserve(3 * tree.leaves());
            for_each_face_pair(tree, enter);
        } else {
            for_each_touching_pair(tree, enter);
        }
        graph = graph_from_pairs(centres.size(), pairs);
    } else {
        graph.first.reserve(centres.size() + 1);
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
    graph.positions = std::move(centres);
    return leaves;
}

}  // namespace controlspace
