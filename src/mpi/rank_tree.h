// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "controlspace/space/adaptation.h"
#include "space/goal_field.h"
#include "space/shared_builder.h"
#include "trees/control_nodes.h"
#include "trees/metric_tree.h"
#include "trees/model_state.h"
#include "trees/topology/topology_state.h"

// Octrees that are exact in some octants, which they are cut into beforehand: what is cut in an
// octant depends on nothing outside of it but the field.

namespace controlspace {

/// Calls split(leaf) until the octants, leaves of an octree over the same domain, are leaves.
template <class Tree, class Split>
void cut_to(std::span<const Box> octants, const Tree& tree, const Split& split) {
    for (const Box& octant : octants) {
        for (Box cell; (cell = tree.cell_at(octant.centre())) != octant;) split(cell);
    }
}

/// For insertion and gradation.
class InsertedPart : public MetricTree<OctreeNode> {
public:
    InsertedPart(const SpaceOptions& options, MakeLeafModel<OctreeNode> make_model, bool balanced,
                 std::span<const Box> octants)
        : MetricTree<OctreeNode>(options, make_model, balanced) {
        std::vector<LeafIndex> cut;
        balanced_ = false;  // trees are balanced after insertion
        cut_to(octants, *this, [&](const Box& cell) { split_across(cell, {}, cut); });
        balanced_ = balanced;
    }
};

/// Adapted to a field in its octants alone, and balanced for what is cut there.
class AdaptedPart : public GrowingTree<OctreeNode> {
public:
    AdaptedPart(const SpaceOptions& options, MakeLeafModel<OctreeNode> make_model, bool balanced,
                std::span<const Box> octants)
        : GrowingTree<OctreeNode>(options, make_model, false) {
        std::vector<LeafIndex> cut;
        cut_to(octants, *this, [&](const Box& cell) { split_across(cell, {}, cut); });
        balanced_ = balanced;
        if (balanced) balance();
    }

    /// As GrowingTree's, by a GoalField that keeps `most_answers`, where is_inside(centre of a
    /// box); `reached` is that of all leaves, which says nothing, `met` that of those inside.
    AdaptationReport adapt(const AdaptationGoal& goal, std::size_t most_answers,
                           const std::function<bool(const Point&)>& is_inside) {
        const GoalField field(goal, domain(), most_answers);
        AdaptationReport report;
        follow(field, goal, {}, true,
               [&](const CellBox& leaf, const std::array<double, 3>& along,
                   std::vector<LeafIndex>& cut) {
                   if (!is_inside(leaf.box.centre())) return false;
                   if (is_negligible(leaf.box, field.largest_ratio())) {
                       report.shortfall = steepness_shortfall();
                       return false;
                   }
                   if (split_across(leaf.box, along, cut)) return true;
                   report.shortfall = depth_shortfall(max_depth(), deepest_level<OctreeNode>);
                   return false;
               });
        report.met = report.shortfall.empty();
        settle();
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        return nodes_of_tree(topology_, *model_, neighbourhood);
    }
    bool has_lengths() const { return false; }
    void save(StateWriter& state) const {
        controlspace::save(topology_, state);
        save_model(*model_, model_->metrics(), state);
    }
};

}  // namespace controlspace
