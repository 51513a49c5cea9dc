// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "trees/topology/topology.h"

namespace controlspace {

/// The planes that the cuts of a tree stand on, along each axis from the low face of the domain to
/// the high one. Leaves are many and planes few, so that a leaf's box is kept in six numbers of
/// planes, exactly.
class CutPlanes {
public:
    template <class Node>
    explicit CutPlanes(const Topology<Node>& tree) {
        const Box& domain = tree.domain();
        for (std::size_t i = 0; i < tree.inner_nodes(); ++i) {
            const Subdivision cut = tree.node(Ref::inner(i)).subdivision(domain);
            for (Axis a = 0; a < 3; ++a) {
                if (cut.cuts[index(a)]) planes_[index(a)].push_back(cut.at[a]);
            }
        }
        for (Axis a = 0; a < 3; ++a) {
            std::vector<double>& planes = planes_[index(a)];
            planes.push_back(domain.low[a]);
            planes.push_back(domain.high[a]);
            std::sort(planes.begin(), planes.end());
            planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
            planes.shrink_to_fit();
        }
    }

    /// Number of the plane at `x`, which must be one.
    std::size_t number(Axis a, double x) const {
        const std::vector<double>& planes = planes_[index(a)];
        return static_cast<std::size_t>(std::lower_bound(planes.begin(), planes.end(), x) -
                                        planes.begin());
    }
    double at(Axis a, std::size_t number) const { return planes_[index(a)][number]; }
    /// Most planes along an axis.
    std::size_t most() const {
        return std::max({planes_[0].size(), planes_[1].size(), planes_[2].size()});
    }
    std::size_t bytes() const {
        return (planes_[0].capacity() + planes_[1].capacity() + planes_[2].capacity()) *
               sizeof(double);
    }

private:
    static std::size_t index(Axis a) { return static_cast<std::size_t>(a); }

    std::array<std::vector<double>, 3> planes_;
};

/// A box as numbers of planes.
template <class Number>
struct Faces {
    std::array<Number, 3> low{};
    std::array<Number, 3> high{};

    [[gnu::always_inline]] Box box(const CutPlanes& planes) const {
        return {{planes.at(0, low[0]), planes.at(1, low[1]), planes.at(2, low[2])},
                {planes.at(0, high[0]), planes.at(1, high[1]), planes.at(2, high[2])}};
    }
};

/// Calls visit(leaf, faces) for all leaves, depth first.
template <class Number, class Node, class Visit>
void for_each_faces(const Topology<Node>& tree, const CutPlanes& planes, Visit&& visit) {
    const auto number = [&](Axis a, double x) { return static_cast<Number>(planes.number(a, x)); };
    const auto descend = [&](const auto& self, Ref ref, const Faces<Number>& faces) -> void {
        if (ref.is_leaf()) {
            visit(LeafIndex{ref.index()}, faces);
            return;
        }
        const Node& node = tree.node(ref);
        const Subdivision cut = node.subdivision(tree.domain());
        std::array<Number, 3> at{};
        for (Axis a = 0; a < 3; ++a) {
            const auto axis = static_cast<std::size_t>(a);
            if (cut.cuts[axis]) at[axis] = number(a, cut.at[a]);
        }
        for (int c = 0; c < cut.children(); ++c) {
            Faces<Number> part = faces;
            for (Axis a = 0; a < 3; ++a) {
                const auto axis = static_cast<std::size_t>(a);
                if (cut.cuts[axis]) (cut.side(c, a) == 0 ? part.high : part.low)[axis] = at[axis];
            }
            self(self, node.children[node.slot(c)], part);
        }
    };
    Faces<Number> all;
    for (Axis a = 0; a < 3; ++a) {
        all.high[static_cast<std::size_t>(a)] = number(a, tree.domain().high[a]);
    }
    descend(descend, tree.root(), all);
}

}  // namespace controlspace
