#pragma once

#include "controlspace/trees/topology.h"

namespace controlspace {

/// Calls visit(leaf, leaf) for every pair of leaves that touch, at a face, an edge or a corner:
/// each pair once.
template <class Node, class Visit>
class TouchingPairs {
public:
    TouchingPairs(const Topology<Node>& tree, Visit& visit) : tree_(tree), visit_(visit) {
        within(Cell{tree.root(), tree.domain()});
    }

private:
    struct Cell {
        Ref ref;
        Box box;
    };
    using Children = std::array<Cell, Topology<Node>::arity>;

    Children children(const Cell& cell) const {
        const Node& node = tree_.node(cell.ref);
        const Subdivision subdivision = node.subdivision(cell.box);
        Children parts;
        for (std::size_t c = 0; c < parts.size(); ++c) {
            parts[c] = {node.children[c], subdivision.child(static_cast<int>(c))};
        }
        return parts;
    }

    void within(const Cell& cell) {
        if (cell.ref.is_leaf()) return;
        const Children parts = children(cell);
        for (std::size_t c = 0; c < parts.size(); ++c) {
            within(parts[c]);
            for (std::size_t other = 0; other < c; ++other) between(parts[other], parts[c]);
        }
    }

    void between(const Cell& a, const Cell& b) {
        if (!touch(a.box, b.box)) return;
        if (!a.ref.is_leaf()) {
            for (const Cell& part : children(a)) between(part, b);
        } else if (!b.ref.is_leaf()) {
            for (const Cell& part : children(b)) between(a, part);
        } else {
            visit_(LeafIndex{a.ref.index()}, LeafIndex{b.ref.index()});
        }
    }

    static bool touch(const Box& a, const Box& b) {
        return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
    }

    const Topology<Node>& tree_;
    Visit& visit_;
};

template <class Node, class Visit>
void for_each_touching_pair(const Topology<Node>& tree, Visit&& visit) {
    TouchingPairs<Node, Visit>(tree, visit);
}

}  // namespace controlspace
