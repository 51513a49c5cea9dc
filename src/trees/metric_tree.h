// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space_builder.h"
#include "space/given_sources.h"
#include "trees/growing_tree.h"

namespace controlspace {

/// A tree whose control nodes carry metrics, for SharedBuilder: the cut and the model are
/// independent of each other, insertion (paper §3.1) is the same for all. Balanced trees are
/// balanced after insertion; after every source with SpaceOptions::vertices_in_turn.
template <class Node>
class MetricTree : public GrowingTree<Node> {
    using Base = GrowingTree<Node>;

protected:
    using Base::is_finished_, Base::model_, Base::options_, Base::topology_;

public:
    MetricTree(const SpaceOptions& options, MakeLeafModel<Node> make_model, bool balanced = false)
        : Base(options, make_model, balanced), collects_(!options.vertices_in_turn) {}

    InsertionReport insert(std::span<const PointSource> sources);

    ControlNodes control_nodes(Neighbourhood neighbourhood) const;
    double largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const;
    void assign(std::span<const Metric> metrics);
    GradationReport grade(const NodeGradation& gradation);
    AdaptationReport adapt(const AdaptationGoal& goal);

    void finish();
    Footprint footprint() const;

    /// Whether all metrics are isotropic, and lengths need no tensors.
    bool has_lengths() const;
    void sample_lengths(std::span<const Point> x, std::span<double> out) const;
    double length_at(const Point& x) const;
    /// Null where it would remember nothing.
    std::unique_ptr<Cursor> length_cursor() const { return model_->cursor(topology_); }

    std::unique_ptr<ControlSpace> pack(Precision precision) const;
    void save(StateWriter& state) const;
    void load(const StateReader& state);

private:
    NodeMetrics& metrics() { return model_->metrics(); }
    const NodeMetrics& metrics() const { return model_->metrics(); }

    void collect();
    void end_collection();
    void forget_requests();
    MetricTree collected() const;
    void insert_by_leaf(const std::function<std::span<Metric>()>& field,
                        const std::function<void(std::size_t)>& grow,
                        std::span<const PointSource> sources, InsertionReport& report);
    void insert_in_turn(std::span<const PointSource> sources, InsertionReport& report);
    Insertion insert_valid(const PointSource& source);

    // As long as nothing but insertion has changed it: what leaves request (of a model that
    // collects that; nothing before the first), and whether the nodes have been set to it, or the
    // tree is balanced.
    bool collects_;
    bool are_collected_ = true;
    std::vector<Metric> requests_;
};

extern template class MetricTree<KdNode>;
extern template class MetricTree<OctreeNode>;

}  // namespace controlspace
