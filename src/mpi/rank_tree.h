// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "controlspace/space/adaptation.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/adapt_tree.h"
#include "controlspace/trees/detail/metric_tree.h"

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
template <class Storage>
class InsertedPart : public MetricTree<OctreeNode, Storage> {
public:
    InsertedPart(const SpaceOptions& options, bool balanced, std::span<const Box> octants)
        : MetricTree<OctreeNode, Storage>(options, balanced) {
        std::vector<LeafIndex> cut;
        this->balanced_ = false;  // trees are balanced after insertion
        cut_to(octants, *this, [&](const Box& cell) { this->split_across(cell, {}, cut); });
        this->balanced_ = balanced;
    }
};

/// Adapted to a field in its octants alone, and balanced for what is cut there.
template <class Storage>
class AdaptedPart : public GrowingTree<OctreeNode, Storage> {
    using Growing = GrowingTree<OctreeNode, Storage>;
    using Growing::is_negligible, Growing::options_, Growing::storage_, Growing::topology_;

public:
    AdaptedPart(const SpaceOptions& options, bool balanced, std::span<const Box> octants)
        : Growing(options, false) {
        std::vector<LeafIndex> cut;
        cut_to(octants, *this, [&](const Box& cell) { this->split_across(cell, {}, cut); });
        this->balanced_ = balanced;
        if (balanced) this->balance();
    }

    /// As GrowingTree's, by a GoalField that keeps `most_answers`, where is_inside(centre of a
    /// box); `reached` is that of all leaves, which says nothing, `met` that of those inside.
    AdaptationReport adapt(const AdaptationGoal& goal, std::size_t most_answers,
                           const std::function<bool(const Point&)>& is_inside) {
        const GoalField field(goal, this->domain(), most_answers);
        AdaptationReport report;
        TreeAdaptation adaptation(topology_, storage_, field, goal);
        adaptation.run(true, [&](const Box& box, const auto& along, auto& cut) {
            if (!is_inside(box.centre())) return false;
            if (is_negligible(box, field.largest_ratio())) {
                report.shortfall =
                    "the field is steep: leaves far shorter than an element are not cut: raise "
                    "target_delta";
                return false;
            }
            if (this->split_across(box, along, cut)) return true;
            report.shortfall = depth_shortfall(this->max_depth(), deepest_level<OctreeNode>);
            return false;
        });
        report.met = report.shortfall.empty();
        this->settle();
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        return nodes_of_tree(topology_, storage_, neighbourhood);
    }
    bool has_lengths() const { return false; }
    void save(StateWriter& state) const {
        controlspace::save(topology_, state);
        save_storage(storage_, storage_.metrics(), state);
    }
};

}  // namespace controlspace
