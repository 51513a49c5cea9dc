// SPDX-License-Identifier: Apache-2.0
#include "trees/values/constant_values.h"

#include <cmath>
#include <utility>

#include "controlspace/metric/nonconformity.h"
#include "space/goal_field.h"
#include "trees/adaptation/cell_judge.h"
#include "trees/in_parallel.h"
#include "trees/packing/packed_tree.h"

namespace controlspace {

template <class Node>
void ConstantValues<Node>::values(const Topology<Node>&, std::span<const LeafIndex> leaves,
                                  std::span<const Point>, std::span<Metric> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = this->metrics_[leaves[i]];
}

template <class Node>
void ConstantValues<Node>::lengths(const Topology<Node>&, std::span<const LeafIndex> leaves,
                                   std::span<const Point>, std::span<double> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = this->metrics_[leaves[i]].xx;
}

template <class Node>
std::unique_ptr<ControlSpace> ConstantValues<Node>::compact(const Topology<Node>& tree,
                                                            Precision precision) const {
    std::vector<LeafIndex> former;
    Topology<Node> ordered = tree.depth_first(former);
    const auto metrics = this->metrics_.field();
    return with_stored<true>(precision, metrics,
                             [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
                                 PackedLeaves<M> values(StoredMetrics<M>(metrics, former));
                                 return std::make_unique<PackedTree<Node, PackedLeaves<M>>>(
                                     std::move(ordered), std::move(values));
                             });
}

template <class Node>
bool ConstantValues<Node>::has_bounds(const GoalField& field) const {
    return field.has_ranges();
}

template <class Node>
std::vector<Judgement> ConstantValues<Node>::fit(std::span<const CellBox> leaves,
                                                 const FieldToFit& to) {
    const GoalField& field = to.goal;
    if (!field.has_ranges()) return LeafMetrics<Node>::fit(leaves, to);
    std::vector<Judgement> judgements(leaves.size());
    in_parallel(leaves.size(), [&, nearby = NearbyField(field)](std::size_t i) mutable {
        const CellBox& leaf = leaves[i];
        nearby.enter(leaf.box, false);
        const auto [least, most] = nearby.range();
        const Metric middle = Metric::isotropic(std::sqrt(least * most));
        this->metrics_.set(leaf.cell, middle);
        Judgement& judged = judgements[i];
        judged.delta = nonconformity(middle, Metric::isotropic(most));
        judged.where = leaf.box.centre();
        if (!(judged.delta > field.target())) return;
        judged.verdict = Judgement::Verdict::exceeded;
        if (Node::arity == 2) judged.along = change_along(leaf.box, nearby);
    });
    return judgements;
}

template class ConstantValues<KdNode>;
template class ConstantValues<OctreeNode>;

}  // namespace controlspace
