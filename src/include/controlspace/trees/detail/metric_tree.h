// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "controlspace/trees/detail/control_nodes.h"
#include "controlspace/trees/detail/growing_tree.h"
#include "controlspace/trees/detail/leaf_growth.h"
#include "controlspace/trees/detail/met_sources.h"
#include "controlspace/trees/detail/packed_tree.h"

namespace controlspace {

/// Whether the nodes of a storage collect what the leaves of a tree request.
template <class Storage, class Node>
concept CollectsRequests = requires(Storage& s, const Topology<Node>& tree,
                                    std::span<const Metric> metrics) {
    s.collect(tree, metrics);
};

/// Whether a storage has a cursor of its own for lengths.
template <class Storage, class Node>
concept HasCursor = requires(const Storage& s, const Topology<Node>& tree) {
    s.cursor(tree);
};

/// A tree whose control nodes carry metrics, for SharedBuilder: the cut and the storage are
/// independent of each other, insertion (paper §3.1) is the same for all. Balanced trees are
/// balanced after insertion; after every source with SpaceOptions::vertices_in_turn.
template <class Node, class Storage>
class MetricTree : public GrowingTree<Node, Storage> {
    using Base = GrowingTree<Node, Storage>;

protected:
    using Base::deepest_, Base::is_finished_, Base::options_, Base::storage_, Base::topology_;

public:
    static constexpr int order = Storage::order;

    explicit MetricTree(const SpaceOptions& options, bool balanced = false)
        : Base(options, balanced), collects_(!options.vertices_in_turn) {}

    InsertionReport insert(std::span<const PointSource> sources) {
        is_finished_ = false;
        InsertionReport report;
        // A leaf is its own metric alone: leaves grow at the same time.
        if constexpr (HasConstantLeaves<Storage>) {
            // It is balanced later, so that it does not depend on which leaf was cut when.
            const bool balances = Base::balanced_ && collects_;
            if (balances) are_collected_ = false;
            if (balances || !Base::balanced_) {
                insert_by_leaf([&] { return metrics().field(); },
                               [&](std::size_t more) { metrics().grow(more); }, sources, report);
            }
        } else if constexpr (CollectsRequests<Storage, Node>) {
            if (collects_) {
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
        }
        insert_in_turn(sources, report);
        const bool waits = Base::balanced_ && !are_collected_;
        if (!is_finished_ && !waits && sources.size() > topology_.leaves() / 16) finish();
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        if (!are_collected_) return collected().control_nodes(neighbourhood);
        return nodes_of_tree(topology_, storage_, neighbourhood);
    }
    double largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const {
        if (!are_collected_) return collected().largest_gradation(neighbourhood, law);
        return largest_gradation_of_tree(topology_, storage_, neighbourhood, law);
    }
    void assign(std::span<const Metric> metrics) {
        end_collection();
        assign_nodes(topology_, storage_, metrics);
    }

    GradationReport grade(const NodeGradation& gradation) {
        end_collection();
        if (!gradation.field) Base::require_memory_to_grade(gradation.options.neighbourhood);
        topology_.fit_jumps();
        return grade_nodes(topology_, storage_, gradation);
    }

    AdaptationReport adapt(const AdaptationGoal& goal) {
        forget_requests();
        AdaptationReport report = Base::adapt(goal, [] {});
        finish();
        return report;
    }

    void finish() {
        collect();
        Base::settle();
    }
    Footprint footprint() const {
        Footprint footprint = Base::footprint();
        footprint.bytes_auxiliary += requests_.capacity() * sizeof(Metric);
        return footprint;
    }

    /// Whether all metrics are isotropic, and sample_lengths answers.
    bool has_lengths() const {
        return AnswersLengths<Storage, Node> &&
               std::ranges::all_of(metrics().field(), is_isotropic);
    }
    void sample_lengths(std::span<const Point> x,
                        std::span<double> out) const requires AnswersLengths<Storage, Node> {
        sample_leaves(topology_, field_of(storage_), x, out);
    }
    double length_at(const Point& x) const requires AnswersLengths<Storage, Node> {
        return value_at<double>(topology_, field_of(storage_), x);
    }

    std::unique_ptr<Cursor> length_cursor() const requires HasCursor<Storage, Node> {
        return storage_.cursor(topology_);
    }

    std::unique_ptr<ControlSpace> pack(Precision precision) const {
        if (!are_collected_) return collected().pack(precision);
        return pack_tree(topology_, storage_, options_, precision);
    }

    void save(StateWriter& state) const {
        if (!are_collected_) return collected().save(state);
        controlspace::save(topology_, state);
        save_storage(storage_, metrics(), state);
    }
    void load(const StateReader& state) {
        forget_requests();
        is_finished_ = true;
        topology_ = load_topology<Node>(Base::domain(), state);
        load_storage(storage_, topology_, state);
    }

private:
    NodeMetrics& metrics() { return storage_.metrics(); }
    const NodeMetrics& metrics() const { return storage_.metrics(); }

    // Sets the nodes to what the leaves request, or balances what has grown.
    void collect() {
        if (are_collected_) return;
        if constexpr (CollectsRequests<Storage, Node>) {
            if (Base::brick_levels_ > 0) {
                Base::complete_bricks([&](LeafIndex leaf, std::size_t times) {
                    make_room(requests_, times);
                    requests_.insert(requests_.end(), times, Metric(requests_[leaf]));
                });
            }
            storage_.collect(topology_, requests_);
        }
        if (Base::balanced_) Base::balance();
        are_collected_ = true;
        Base::bytes_to_come_ = 0;
        Base::require_memory(topology_.leaves());
    }
    // From now on the nodes alone count.
    void end_collection() {
        if (!are_collected_) finish();
        forget_requests();
    }
    void forget_requests() {
        requests_ = std::vector<Metric>();  // its memory too
        are_collected_ = true;
        collects_ = false;
        Base::bytes_to_come_ = 0;
    }
    MetricTree collected() const {
        MetricTree copy = *this;
        copy.collect();
        return copy;
    }

    // Leaves alone, each with one metric: field() is these, grow(more) appends some.
    template <class Field, class Grow>
    void insert_by_leaf(const Field& field, const Grow& grow, std::span<const PointSource> sources,
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
    void insert_in_turn(std::span<const PointSource> sources, InsertionReport& report) {
        MetSources met;
        while (report.sources < sources.size()) {
            const auto part = met.next_part(sources.subspan(report.sources));
            met.find(topology_, storage_, options_.tolerance, part);
            for (std::size_t k = 0; k < part.size(); ++k, ++report.sources) {
                if (met.is_met(k)) continue;
                require_valid(part[k], report.sources, Base::domain());
                if (insert_valid(part[k]) == Insertion::inserted) ++report.inserted;
            }
        }
    }

    Insertion insert_valid(const PointSource& source) {
        const Metric held = value_at(topology_, requested_of(storage_), source.position);
        if (!calls_for_change(source.metric, held, options_.tolerance)) {
            return Insertion::already_met;
        }
        lower_nodes(storage_, Base::cut_for(source), source.metric);
        return Insertion::inserted;
    }

    // As long as nothing but insertion has changed it: what leaves request (of a storage that
    // collects that; nothing before the first), and whether the nodes have been set to it, or the
    // tree is balanced.
    static constexpr std::size_t bytes_collected_per_leaf = 224;
    bool collects_;
    bool are_collected_ = true;
    std::vector<Metric> requests_;
};

}  // namespace controlspace
