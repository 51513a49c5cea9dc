#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "spaces/topology.h"

namespace controlspace {

/// For each face of a leaf (2 axis for the low one, 2 axis + 1 for the high one) the deepest part
/// of the tree that holds all across it, mostly a leaf; at the domain's border the leaf itself.
using PartsAcross = std::array<Ref, 6>;

/// Finds them on one walk through a tree.
template <class Node, class Visit>
class PartsAcrossWalk {
public:
    PartsAcrossWalk(const Topology<Node>& tree, Visit& visit) : tree_(tree), visit_(visit) {}

    /// `across` are the parts across the faces of `part`, or larger ones.
    void walk(const TreePart& part, PartsAcross across) {
        for (int face = 0; face < 6; ++face) {
            Ref& opposite = across[static_cast<std::size_t>(face)];
            opposite =
                is_at_border(part.box, face) ? part.ref : deepest_across(opposite, part.box, face);
        }
        if (part.ref.is_leaf()) {
            visit_(LeafIndex{part.ref.index()}, part.box, across);
            return;
        }
        const Node& node = tree_.node(part.ref);
        const Subdivision cut = node.subdivision(part.box);
        for (int c = 0; c < Node::arity; ++c) {
            PartsAcross of_child = across;
            int bit = 1;
            for (Axis a = 0; a < 3; ++a) {
                if (!cut.cuts[static_cast<std::size_t>(a)]) continue;
                const auto sibling = static_cast<std::size_t>(c ^ bit);
                of_child[face_of(a, cut.side(c, a) == 0)] = node.children[sibling];
                bit *= 2;
            }
            walk(tree_.child(part, c), of_child);
        }
    }

private:
    static std::size_t face_of(Axis a, bool high) {
        return static_cast<std::size_t>(2 * a + (high ? 1 : 0));
    }
    bool is_at_border(const Box& box, int face) const {
        const Axis a = face / 2;
        const Box& all = tree_.domain();
        return face % 2 == 1 ? box.high[a] >= all.high[a] : box.low[a] <= all.low[a];
    }

    Ref deepest_across(Ref part, const Box& box, int face) const {
        while (!part.is_leaf()) {
            const Node& node = tree_.node(part);
            const int c = child_across(node.subdivision(box), box, face);
            if (c < 0) break;
            part = node.children[static_cast<std::size_t>(c)];
        }
        return part;
    }

    // The one child of what `cut` cuts that has all across a face of `box`; -1 if several have.
    static int child_across(const Subdivision& cut, const Box& box, int face) {
        int child = 0;
        int bit = 1;
        for (Axis a = 0; a < 3; ++a) {
            if (!cut.cuts[static_cast<std::size_t>(a)]) continue;
            if (a == face / 2) {
                if (face % 2 == 0) child += bit;
            } else if (cut.at[a] <= box.low[a]) {
                child += bit;
            } else if (cut.at[a] < box.high[a]) {
                return -1;
            }
            bit *= 2;
        }
        return child;
    }

    const Topology<Node>& tree_;
    Visit& visit_;
};

/// Calls visit(leaf, box, parts) for all leaves, depth first.
template <class Node, class Visit>
void for_each_parts_across(const Topology<Node>& tree, Visit&& visit) {
    PartsAcrossWalk<Node, Visit>(tree, visit).walk({tree.root(), tree.domain()}, {});
}

}  // namespace controlspace
