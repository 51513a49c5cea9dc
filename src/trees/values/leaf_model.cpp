// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/leaf_model.h"

#include <algorithm>
#include <array>
#include <limits>

#include "trees/model_state.h"
#include "trees/sample_leaves.h"

namespace controlspace {

template <class Node>
void LeafModel<Node>::lengths(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                              std::span<const Point> x, std::span<double> out) const {
    std::array<Metric, Topology<Node>::most_found> metrics;
    const std::span<Metric> part = std::span(metrics).first(x.size());
    values(tree, leaves, x, part);
    std::ranges::transform(part, out.begin(), [](const Metric& m) { return m.xx; });
}

template <class Node>
Metric LeafModel<Node>::requested(const Topology<Node>& tree, LeafIndex leaf,
                                  const Point& x) const {
    return value_in(tree, *this, leaf, x);
}

template <class Node>
void LeafModel<Node>::ceilings(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                               std::span<const Point> x, std::span<double> out) const {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (this->traits_.follows_neighbours) {
        std::ranges::fill(out, none);
        return;
    }
    std::array<Metric, Topology<Node>::most_found> metrics;
    const std::span<Metric> part = std::span(metrics).first(x.size());
    values(tree, leaves, x, part);
    std::ranges::transform(part, out.begin(),
                           [&](const Metric& m) { return is_isotropic(m) ? m.xx : none; });
}

template <class Node>
void LeafModel<Node>::loaded(const Topology<Node>& tree, const StateReader& state) {
    this->metrics_.require_sound(state, tree.leaves());
    require_sound_arrays(*this, tree.leaves(), state);
}

template class LeafModel<KdNode>;
template class LeafModel<OctreeNode>;

}  // namespace controlspace
