// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "trees/packing/frozen_leaves.h"
#include "trees/packing/frozen_tree.h"
#include "trees/topology/parts_across.h"
#include "trees/values/quadratic_in_leaves.h"

namespace controlspace {

template <class Plane>
struct QuadraticLeaf {
    Faces<Plane> faces;
    PartsAcross across;
};

/// One metric a leaf, interpolated with those of the neighbours.
template <class M, class Plane>
class FrozenQuadratic : public FrozenLeaves<M, QuadraticLeaf<Plane>> {
    using Base = FrozenLeaves<M, QuadraticLeaf<Plane>>;
    using Base::planes_, Base::metrics_, Base::leaves_;

public:
    template <class Node>
    FrozenQuadratic(const Topology<Node>& tree, CutPlanes planes, StoredMetrics<M> metrics,
                    const QuadraticRule& rule)
        : Base(std::move(planes), std::move(metrics)), rule_(rule) {
        leaves_.reserve(tree.leaves());
        for_each_faces<Plane>(tree, planes_, [&](LeafIndex, const Faces<Plane>& faces) {
            leaves_.push_back({faces, {}});
        });
        for_each_parts_across(tree, [&](LeafIndex leaf, const Box&, const PartsAcross& across) {
            leaves_[leaf].across = across;
        });
        isotropic_ = is_stored_length<M> || std::ranges::all_of(metrics_.metrics(), is_isotropic);
    }

    template <class Node, class Value>
    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Value> out) const {
        QuadraticInLeaves(tree, *this).interpolate(leaves, x, out);
    }

    const PartsAcross& parts_across(LeafIndex leaf, const Point&) const {
        return leaves_[leaf].across;
    }
    Metric metric(LeafIndex leaf) const { return metrics_[leaf]; }
    void prefetch_metric(LeafIndex leaf) const { __builtin_prefetch(&metrics_.items()[leaf]); }
    double length(LeafIndex leaf) const { return length_of(metrics_[leaf]); }
    bool all_isotropic() const { return isotropic_; }
    double slope() const { return rule_.slope; }
    QuadraticForm form() const { return rule_.form; }

    template <class Node>
    std::unique_ptr<Cursor> cursor(const Topology<Node>&) const {
        return nullptr;
    }
    template <class Node>
    ControlNodes control_nodes(const Topology<Node>& tree, Neighbourhood neighbourhood) const {
        return {leaf_graph(tree, neighbourhood).graph, metrics_.metrics()};
    }
    template <class Node>
    void save(const Topology<Node>&, StateWriter& state) const {
        NodeMetrics::exchange(saved_metrics<M>(metrics_.metrics()), state);
        state("quadratic.slope", rule_.slope);
    }

private:
    QuadraticRule rule_;
    bool isotropic_;
};

template <class Node>
std::unique_ptr<ControlSpace> freeze_quadratic(const Topology<Node>& tree,
                                               std::span<const Metric> metrics,
                                               const QuadraticRule& rule, Precision precision) {
    std::vector<LeafIndex> order;
    Topology<Node> ordered = tree.depth_first(order);
    CutPlanes planes(ordered);
    return with_stored<true>(precision, metrics, [&]<class M>(std::type_identity<M>) {
        return with_plane(planes, [&]<class Plane>(Plane) {
            FrozenQuadratic<M, Plane> values(ordered, std::move(planes),
                                             StoredMetrics<M>(metrics, order), rule);
            return frozen(std::move(ordered), std::move(values));
        });
    });
}

}  // namespace controlspace
