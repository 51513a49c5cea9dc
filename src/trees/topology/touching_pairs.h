// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trees/topology/topology.h"

namespace controlspace {

/// Calls visit(leaf, leaf) for every pair of leaves that touch, at a face, an edge or a corner:
/// each pair once.
template <class Node, class Visit>
class TouchingPairs {
public:
    TouchingPairs(const Topology<Node>& tree, Visit& visit) : tree_(tree), visit_(visit) {
        within({tree.root(), tree.domain()});
    }

private:
    void within(const TreePart& part) {
        if (part.ref.is_leaf()) return;
        for (int c = 0; c < tree_.node(part.ref).count(); ++c) {
            const TreePart child = tree_.child(part, c);
            within(child);
            for (int other = 0; other < c; ++other) between(tree_.child(part, other), child);
        }
    }

    void between(const TreePart& a, const TreePart& b) {
        if (!touch(a.box, b.box)) return;
        if (a.ref.is_leaf() && b.ref.is_leaf()) {
            visit_(LeafIndex{a.ref.index()}, LeafIndex{b.ref.index()});
            return;
        }
        if (a.ref.is_leaf()) {
            tree_.for_each_child(b, [&](const TreePart& child) { between(a, child); });
        } else {
            tree_.for_each_child(a, [&](const TreePart& child) { between(child, b); });
        }
    }

    const Topology<Node>& tree_;
    Visit& visit_;
};

template <class Node, class Visit>
void for_each_touching_pair(const Topology<Node>& tree, Visit&& visit) {
    TouchingPairs<Node, Visit>(tree, visit);
}

}  // namespace controlspace
