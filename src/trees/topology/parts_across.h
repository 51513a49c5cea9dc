// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "trees/topology/topology.h"
#include "trees/topology/work_through.h"

namespace controlspace {

/// For each face of a leaf (2 axis for the low one, 2 axis + 1 for the high one) the deepest part
/// of the tree that holds all across it, mostly a leaf; at the domain's border the leaf itself.
using PartsAcross = std::array<Ref, 6>;

/// Finds them on one walk through a tree.
template <class Node, class Visit>
class PartsAcrossWalk {
public:
    PartsAcrossWalk(const Topology<Node>& tree, const Visit& visit) : tree_(tree), visit_(visit) {}

    /// A part of the tree with the parts across its faces, or larger ones.
    struct Item {
        TreePart part;
        PartsAcross across;
    };
    Item whole() const { return {{tree_.root(), tree_.domain()}, {}}; }

    /// Visits a leaf; calls next(item) for the children of an inner node.
    template <class Next>
    void operator()(Item item, Next&& next) const {
        const TreePart& part = item.part;
        for (int face = 0; face < 6; ++face) {
            Ref& across = item.across[static_cast<std::size_t>(face)];
            if (is_at_border(part.box, face)) {
                across = part.ref;
            } else {
                // One step is enough on the way: the children go on from there.
                while (step_down(across, part.box, face) && part.ref.is_leaf()) {
                }
                prefetch(across);
            }
        }
        if (part.ref.is_leaf()) {
            visit_(LeafIndex{part.ref.index()}, part.box, item.across);
            return;
        }
        const Node& node = tree_.node(part.ref);
        const Subdivision cut = node.subdivision(part.box);
        for (int c = 0; c < cut.children(); ++c) {
            Item child{{node.children[node.slot(c)], cut.child(c)}, item.across};
            int bit = 1;
            for (Axis a = 0; a < 3; ++a) {
                if (!cut.cuts[static_cast<std::size_t>(a)]) continue;
                child.across[face_of(a, cut.side(c, a) == 0)] = node.children[node.slot(c ^ bit)];
                bit *= 2;
            }
            prefetch(child.part.ref);
            next(child);
        }
    }

private:
    void prefetch(Ref part) const {
        if (!part.is_leaf()) __builtin_prefetch(&tree_.node(part));
    }
    static std::size_t face_of(Axis a, bool high) {
        return 2 * static_cast<std::size_t>(a) + (high ? 1 : 0);
    }
    bool is_at_border(const Box& box, int face) const {
        const Axis a = face / 2;
        const Box& all = tree_.domain();
        return face % 2 == 1 ? box.high[a] >= all.high[a] : box.low[a] <= all.low[a];
    }

    // Replaces a part by the one child of it that has all across a face of `box`; false if there is
    // none.
    bool step_down(Ref& across, const Box& box, int face) const {
        if (across.is_leaf()) return false;
        const Node& node = tree_.node(across);
        const std::span<const double> planes = node.planes();
        std::size_t child = 0;
        std::size_t bit = 1;
        for (std::size_t i = 0; i < planes.size(); ++i, bit *= 2) {
            const Axis a = node.plane_axis(i);
            if (planes[i] <= box.low[a]) {
                child += bit;
            } else if (a != face / 2 && planes[i] < box.high[a]) {
                return false;
            }
        }
        across = node.children[child];
        return true;
    }

    const Topology<Node>& tree_;
    const Visit& visit_;
};

/// Calls visit(leaf, box, parts) for all leaves, for several at the same time.
template <class Node, class Visit>
void for_each_parts_across(const Topology<Node>& tree, const Visit& visit) {
    const PartsAcrossWalk<Node, Visit> walk(tree, visit);
    work_through(walk.whole(), walk);
}

}  // namespace controlspace
