// SPDX-License-Identifier: Apache-2.0
#include "trees/metric_tree.h"

#include <algorithm>

#include "trees/control_nodes.h"
#include "trees/insertion/leaf_growth.h"
#include "trees/insertion/met_sources.h"
#include "trees/make_room.h"
#include "trees/model_state.h"
#include "trees/sample_leaves.h"
#include "trees/topology/topology_state.h"

namespace controlspace {

namespace {

using ByWhat = ModelTraits::Insertion;

// Of what leaves request, and of the nodes that will be made of it.
constexpr std::size_t bytes_collected_per_leaf = 224;

}  // namespace

template <class Node>
InsertionReport MetricTree<Node>::insert(std::span<const PointSource> sources) {
    is_finished_ = false;
    InsertionReport report;
    const ByWhat by = model_->traits().insertion;
    if (by == ByWhat::by_leaf) {
        // It is balanced later, so that it does not depend on which leaf was cut when.
        const bool balances = Base::balanced_ && collects_;
        if (balances) are_collected_ = false;
        if (balances || !Base::balanced_) {
            insert_by_leaf([&] { return metrics().field(); },
                           [&](std::size_t more) { metrics().grow(more); }, sources, report);
        }
    } else if (by == ByWhat::collected && collects_) {
        if (requests_.empty()) {
            requests_.assign(topology_.leaves(), largest_metric(options_));
        }
        are_collected_ = false;
        Base::bytes_to_come_ = bytes_collected_per_leaf;
        const auto grow = [&](std::size_t more) {
            make_room(requests_, more);
            requests_.resize(requests_.size() + more);
        };
        insert_by_leaf([&] { return std::span(requests_); }, grow, sources, report);
    }
    insert_in_turn(sources, report);
    const bool waits = Base::balanced_ && !are_collected_;
    if (!is_finished_ && !waits && sources.size() > topology_.leaves() / 16) finish();
    return report;
}

template <class Node>
ControlNodes MetricTree<Node>::control_nodes(Neighbourhood neighbourhood) const {
    if (!are_collected_) return collected().control_nodes(neighbourhood);
    return nodes_of_tree(topology_, *model_, neighbourhood);
}

template <class Node>
double MetricTree<Node>::largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const {
    if (!are_collected_) return collected().largest_gradation(neighbourhood, law);
    return largest_gradation_of_tree(topology_, *model_, neighbourhood, law);
}

template <class Node>
void MetricTree<Node>::assign(std::span<const Metric> metrics) {
    end_collection();
    assign_nodes(topology_, *model_, metrics);
}

template <class Node>
GradationReport MetricTree<Node>::grade(const NodeGradation& gradation) {
    end_collection();
    if (!gradation.field) Base::require_memory_to_grade(gradation.options.neighbourhood);
    topology_.fit_jumps();
    return grade_nodes(topology_, *model_, gradation);
}

template <class Node>
AdaptationReport MetricTree<Node>::adapt(const AdaptationGoal& goal) {
    forget_requests();
    AdaptationReport report = Base::adapt(goal, [] {});
    finish();
    return report;
}

template <class Node>
void MetricTree<Node>::finish() {
    collect();
    Base::settle();
}

template <class Node>
Footprint MetricTree<Node>::footprint() const {
    Footprint footprint = Base::footprint();
    footprint.bytes_auxiliary += requests_.capacity() * sizeof(Metric);
    return footprint;
}

template <class Node>
bool MetricTree<Node>::has_lengths() const {
    return model_->traits().has_lengths && std::ranges::all_of(metrics().field(), is_isotropic);
}

template <class Node>
void MetricTree<Node>::sample_lengths(std::span<const Point> x, std::span<double> out) const {
    sample_leaves(
        topology_, x, out,
        [&](std::span<const LeafIndex> leaves, std::span<const Point> part,
            std::span<double> values) { model_->lengths(topology_, leaves, part, values); });
}

template <class Node>
double MetricTree<Node>::length_at(const Point& x) const {
    const LeafIndex leaf = topology_.find(x);
    double length = 0;
    model_->lengths(topology_, {&leaf, 1}, {&x, 1}, {&length, 1});
    return length;
}

template <class Node>
std::unique_ptr<ControlSpace> MetricTree<Node>::pack(Precision precision) const {
    if (!are_collected_) return collected().pack(precision);
    return model_->compact(topology_, precision);
}

template <class Node>
void MetricTree<Node>::save(StateWriter& state) const {
    if (!are_collected_) return collected().save(state);
    controlspace::save(topology_, state);
    save_model(*model_, metrics(), state);
}

template <class Node>
void MetricTree<Node>::load(const StateReader& state) {
    forget_requests();
    is_finished_ = true;
    topology_ = load_topology<Node>(Base::domain(), state);
    load_model(*model_, topology_, state);
}

// Sets the nodes to what the leaves request, or balances what has grown.
template <class Node>
void MetricTree<Node>::collect() {
    if (are_collected_) return;
    if (model_->traits().insertion == ByWhat::collected) {
        if (Base::brick_levels_ > 0) {
            Base::complete_bricks([&](LeafIndex leaf, std::size_t times) {
                make_room(requests_, times);
                requests_.insert(requests_.end(), times, Metric(requests_[leaf]));
            });
        }
        model_->collect(topology_, requests_);
    }
    if (Base::balanced_) Base::balance();
    are_collected_ = true;
    Base::bytes_to_come_ = 0;
    Base::require_memory(topology_.leaves());
}

// From now on the nodes alone count.
template <class Node>
void MetricTree<Node>::end_collection() {
    if (!are_collected_) finish();
    forget_requests();
}

template <class Node>
void MetricTree<Node>::forget_requests() {
    requests_ = std::vector<Metric>();  // its memory too
    are_collected_ = true;
    collects_ = false;
    Base::bytes_to_come_ = 0;
}

template <class Node>
MetricTree<Node> MetricTree<Node>::collected() const {
    MetricTree copy = *this;
    copy.collect();
    return copy;
}

// Leaves alone, each with one metric: field() is these, grow(more) appends some.
template <class Node>
void MetricTree<Node>::insert_by_leaf(const std::function<std::span<Metric>()>& field,
                                      const std::function<void(std::size_t)>& grow,
                                      std::span<const PointSource> sources,
                                      InsertionReport& report) {
    const SourceCuts<Node> cuts = Base::cuts();
    LeafGrowth<Node> growth(cuts, options_.tolerance);
    while (report.sources < sources.size()) {
        const auto batch = growth.next_batch(sources.subspan(report.sources));
        const std::size_t valid = growth.grow(topology_, field(), batch);
        if (valid == 0) require_valid(batch.front(), report.sources, Base::domain());
        Base::bytes_aside_ = growth.bytes();
        Base::make_room_for(growth.leaves_made());
        topology_.grow(growth.cuts_made(), growth.leaves_made());
        grow(growth.leaves_made());
        growth.enter(topology_, field());
        topology_.fit_jumps_roughly();
        report.sources += valid;
        report.inserted += growth.inserted();
    }
    Base::bytes_aside_ = 0;
}

// One after the other, those left after the report's.
template <class Node>
void MetricTree<Node>::insert_in_turn(std::span<const PointSource> sources,
                                      InsertionReport& report) {
    MetSources met;
    while (report.sources < sources.size()) {
        const auto part = met.next_part(sources.subspan(report.sources));
        met.find(topology_, *model_, options_.tolerance, part);
        for (std::size_t k = 0; k < part.size(); ++k, ++report.sources) {
            if (met.is_met(k)) continue;
            require_valid(part[k], report.sources, Base::domain());
            if (insert_valid(part[k]) == Insertion::inserted) ++report.inserted;
        }
    }
}

template <class Node>
Insertion MetricTree<Node>::insert_valid(const PointSource& source) {
    const LeafIndex leaf = topology_.find(source.position);
    const Metric held = model_->requested(topology_, leaf, source.position);
    if (!calls_for_change(source.metric, held, options_.tolerance)) {
        return Insertion::already_met;
    }
    model_->lower(Base::cut_for(source).cell(), source.metric);
    return Insertion::inserted;
}

template class MetricTree<KdNode>;
template class MetricTree<OctreeNode>;

}  // namespace controlspace
