// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/growing_tree.h"
#include "controlspace/trees/detail/leaf_graph.h"
#include "trees/values/anchored_values.h"

namespace controlspace {

/// A tree whose leaves keep sources (K_LA, K_oLA), for SharedBuilder: a query evaluates the
/// cones of the leaf's sources.
template <class Node>
class SourceTree : public GrowingTree<Node, AnchoredValues> {
    using Base = GrowingTree<Node, AnchoredValues>;
    using Base::options_, Base::storage_, Base::topology_, Base::is_finished_;

public:
    explicit SourceTree(const SpaceOptions& options) : Base(options, false) {}

    InsertionReport insert(std::span<const PointSource> sources) {
        is_finished_ = false;
        InsertionReport report;
        LongLists long_lists = storage_.long_lists();
        for (const PointSource& source : sources) {
            require_valid(source, report.sources++, Base::domain());
            // A cone that is less steep than others may be the smallest away from its source.
            const bool are_alike = source.growth == 0 && storage_.sources().all_grow_alike();
            if (are_alike && !calls_for_change(source.metric, held_at(source.position, long_lists),
                                               options_.tolerance)) {
                continue;
            }
            const LeafIndex leaf = Base::cut_for(source).leaf;
            long_lists.added(leaf, storage_.add(leaf, source));
            is_graded_ = false;
            ++report.inserted;
        }
        if (!is_finished_ && sources.size() > topology_.leaves() / 16) finish();
        return report;
    }

    /// Leaf centres with the field there.
    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        LeafGraph leaves = leaf_graph(topology_, neighbourhood);
        std::vector<Metric> metrics;
        metrics.reserve(leaves.order.size());
        for (const Point& x : leaves.graph.positions) {
            metrics.push_back(value_at(topology_, storage_, x));
        }
        return {std::move(leaves.graph), std::move(metrics)};
    }

    /// Finds the sources that govern the leaves; the law is always the cone law. Leaves that a few
    /// sources do not bring near to the field are cut, down to l_min in their own metric; where
    /// there are 64 tensors at most, none is, for it may have all of them. The field gets nowhere
    /// longer, if all is isotropic: a ratio larger than before changes nothing, and what may govern
    /// a place in a leaf stays its anchor. Without new sources or a smaller ratio there is nothing
    /// to do.
    GradationReport grade(const GradationOptions& options) {
        require_valid(options);
        constexpr double close = 0.02;  // non-conformity to the exact field
        const std::vector<PointSource> sources = storage_.sources().all();
        if (is_graded_ && options.ratio >= storage_.ratio())
            return {.largest_ratio_left = ratio_left()};
        const double ratio = std::min(options.ratio, storage_.ratio());
        const AdaptationGoal goal{sources, storage_.continuous(), ratio,
                                  close,   storage_.rule(),       storage_.largest().xx};
        const GoalField field(goal, Base::domain());
        storage_.take_over(goal);
        GradationReport report;
        TreeAdaptation adaptation(topology_, storage_, field, goal, Base::options_.growth);
        adaptation.run(false, [&](const Box& box, const auto& along, auto& cut) {
            ++report.operations;
            return Base::cuts().is_too_long(value_at(topology_, storage_, box.centre()), box) &&
                   Base::split_across(box, along, cut);
        });
        if (adaptation.is_late()) Base::require_may_grow();
        finish();
        is_graded_ = true;
        report.largest_ratio_left = ratio_left();
        return report;
    }

    AdaptationReport adapt(const AdaptationGoal& goal) {
        AdaptationReport report = Base::adapt(goal, [&] { storage_.take_over(goal); });
        finish();
        is_graded_ = true;
        return report;
    }

    void finish() {
        storage_.drop_idle_sources();
        Base::settle();
    }

    void save(StateWriter& state) const {
        controlspace::save(topology_, state);
        storage_.save(state);
        state("sources.is_graded", is_graded_);
    }
    void load(const StateReader& state) {
        is_finished_ = true;
        topology_ = load_topology<Node>(Base::domain(), state);
        storage_.load(topology_, state);
        state("sources.is_graded", is_graded_);
    }

private:
    Metric held_at(const Point& x, LongLists& long_lists) const {
        const LeafIndex leaf = topology_.find(x);
        if (long_lists.is_long(leaf)) return storage_.value(Base::domain(), leaf, x, long_lists);
        return value_in(topology_, storage_, leaf, x);
    }
    double ratio_left() const {
        const ControlNodes nodes = control_nodes(Neighbourhood::faces);
        return largest_gradation(nodes.graph, nodes.metrics, GradationLaw::cone);
    }

    bool is_graded_ = false;  // no source has come since
};

/// The catalogue's row of such a tree.
template <class Node>
CatalogueEntry source_row(const char* id, const char* description) {
    CatalogueEntry row{
        .id = id,
        .description = description,
        .family = "anchored",
        .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
            require_valid(options);
            return std::make_unique<SharedBuilder<SourceTree<Node>>>(options);
        },
        .capabilities = {SourceLeaves(), KeptSources()}};
    if (Node::arity == 2) row.capabilities.push_back(SplitRules());
    return row;
}

}  // namespace controlspace
