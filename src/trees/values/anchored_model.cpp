// SPDX-License-Identifier: Apache-2.0
#include "trees/values/anchored_model.h"

#include "controlspace/space/control_space_builder.h"
#include "space/goal_field.h"
#include "trees/topology/topology.h"

namespace controlspace {

template <class Node>
void AnchoredModel<Node>::values(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                                 std::span<const Point> x, std::span<Metric> out) const {
    if (leaves.size() > 1) {
        for (const LeafIndex leaf : leaves) anchored_.prefetch(leaf);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = anchored_.value(tree.domain(), leaves[i], x[i]);
    }
}

template <class Node>
std::unique_ptr<ControlSpace> AnchoredModel<Node>::compact(const Topology<Node>&, Precision) const {
    refuse_precision();
}

template <class Node>
std::vector<Judgement> AnchoredModel<Node>::fit(std::span<const CellBox> leaves,
                                                const FieldToFit& to) {
    const GoalField& field = to.goal;
    if (!to.is_searched || !field.has_ranges()) {
        anchored_.fit(leaves, field, to.is_searched);
        return {};
    }
    const std::vector<std::uint8_t> is_kept = anchored_.cover(leaves, field);
    std::vector<Judgement> judgements(leaves.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        if (is_kept[i] == 0) judgements[i].verdict = Judgement::Verdict::unknown;
        if (is_kept[i] != 0 && !field.kept().empty()) judgements[i].delta = field.target();
    }
    return judgements;
}

template <class Node>
bool AnchoredModel<Node>::has_bounds(const GoalField& field) const {
    return field.has_ranges();
}

template class AnchoredModel<KdNode>;
template class AnchoredModel<OctreeNode>;

}  // namespace controlspace
