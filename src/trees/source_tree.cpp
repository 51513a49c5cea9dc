// SPDX-License-Identifier: Apache-2.0
#include "trees/source_tree.h"

#include <utility>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "space/goal_field.h"
#include "space/shared_builder.h"
#include "trees/sample_leaves.h"
#include "trees/topology/leaf_graph.h"
#include "trees/topology/topology_state.h"

namespace controlspace {

template <class Node>
SourceTree<Node>::SourceTree(const SpaceOptions& options)
    : Base(
          options,
          [](const SpaceOptions& of) -> std::unique_ptr<LeafModel<Node>> {
              return std::make_unique<AnchoredModel<Node>>(of);
          },
          false) {}

template <class Node>
InsertionReport SourceTree<Node>::insert(std::span<const PointSource> sources) {
    is_finished_ = false;
    InsertionReport report;
    AnchoredValues& values = anchored();
    LongLists long_lists = values.long_lists();
    for (const PointSource& source : sources) {
        require_valid(source, report.sources++, Base::domain());
        // A cone that is less steep than others may be the smallest away from its source.
        const bool are_alike = source.growth == 0 && values.sources().all_grow_alike();
        if (are_alike && !calls_for_change(source.metric, held_at(source.position, long_lists),
                                           options_.tolerance)) {
            continue;
        }
        const LeafIndex leaf = Base::cut_for(source).leaf;
        long_lists.added(leaf, values.add(leaf, source));
        is_graded_ = false;
        ++report.inserted;
    }
    if (!is_finished_ && sources.size() > topology_.leaves() / 16) finish();
    return report;
}

template <class Node>
ControlNodes SourceTree<Node>::control_nodes(Neighbourhood neighbourhood) const {
    LeafGraph leaves = leaf_graph(topology_, neighbourhood);
    std::vector<Metric> metrics;
    metrics.reserve(leaves.order.size());
    for (const Point& x : leaves.graph.positions) metrics.push_back(metric_at(x));
    return {std::move(leaves.graph), std::move(metrics)};
}

template <class Node>
GradationReport SourceTree<Node>::grade(const GradationOptions& options) {
    require_valid(options);
    constexpr double close = 0.02;  // non-conformity to the exact field
    AnchoredValues& values = anchored();
    const std::vector<PointSource> sources = values.sources().all();
    if (is_graded_ && options.ratio >= values.ratio()) {
        return {.largest_ratio_left = ratio_left()};
    }
    const double ratio = std::min(options.ratio, values.ratio());
    const AdaptationGoal goal{sources, values.continuous(), ratio,
                              close,   values.rule(),       values.largest().xx};
    const GoalField field(goal, Base::domain());
    values.take_over(goal);
    GradationReport report;
    const auto adapted = Base::follow(
        field, goal, options_.growth, false,
        [&](const CellBox& leaf, const std::array<double, 3>& along, std::vector<LeafIndex>& cut) {
            ++report.operations;
            return Base::cuts().is_too_long(metric_at(leaf.box.centre()), leaf.box) &&
                   Base::split_across(leaf.box, along, cut);
        });
    if (adapted.is_late) Base::require_may_grow();
    finish();
    is_graded_ = true;
    report.largest_ratio_left = ratio_left();
    return report;
}

template <class Node>
AdaptationReport SourceTree<Node>::adapt(const AdaptationGoal& goal) {
    AdaptationReport report = Base::adapt(goal, [&] { anchored().take_over(goal); });
    finish();
    is_graded_ = true;
    return report;
}

template <class Node>
void SourceTree<Node>::finish() {
    anchored().drop_idle_sources();
    Base::settle();
}

template <class Node>
void SourceTree<Node>::save(StateWriter& state) const {
    controlspace::save(topology_, state);
    anchored().save(state);
    state("sources.is_graded", is_graded_);
}

template <class Node>
void SourceTree<Node>::load(const StateReader& state) {
    is_finished_ = true;
    topology_ = load_topology<Node>(Base::domain(), state);
    anchored().load(topology_.leaves(), state);
    state("sources.is_graded", is_graded_);
}

template <class Node>
Metric SourceTree<Node>::held_at(const Point& x, LongLists& long_lists) const {
    const LeafIndex leaf = topology_.find(x);
    if (long_lists.is_long(leaf)) return anchored().value(Base::domain(), leaf, x, long_lists);
    return anchored().value(Base::domain(), leaf, x);
}

template <class Node>
double SourceTree<Node>::ratio_left() const {
    const ControlNodes nodes = control_nodes(Neighbourhood::faces);
    return largest_gradation(nodes.graph, nodes.metrics, GradationLaw::cone);
}

template <class Node>
std::unique_ptr<ControlSpaceBuilder> make_source_tree(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<SourceTree<Node>>>(options);
}

template class SourceTree<KdNode>;
template class SourceTree<OctreeNode>;
template std::unique_ptr<ControlSpaceBuilder> make_source_tree<KdNode>(const SpaceOptions&);
template std::unique_ptr<ControlSpaceBuilder> make_source_tree<OctreeNode>(const SpaceOptions&);

}  // namespace controlspace
