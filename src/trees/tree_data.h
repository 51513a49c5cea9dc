#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <type_traits>

#include "controlspace/error.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/space_options.h"
#include "gradation/regrade.h"
#include "trees/insertion/leaf_growth.h"
#include "trees/insertion/met_sources.h"
#include "trees/insertion/published_bytes.h"
#include "trees/insertion/source_cuts.h"
#include "trees/packing/frozen_state.h"
#include "trees/regradation/past_state.h"
#include "trees/topology/adjacency.h"
#include "trees/topology/sample_leaves.h"
#include "trees/topology/topology.h"
#include "trees/topology/topology_state.h"
#include "trees/values/anchored_values.h"
#include "trees/values/leaf_values.h"

namespace controlspace {

/// A tree over a box as SharedBuilder wants it: the paper's table with one switch, how a box is cut
/// (`Node`) and where the control nodes are (`Storage`). Insertion (§3.1) is the same for all.
template <class Node, class Storage>
class TreeData {
    static constexpr bool keeps_sources = std::is_same_v<Storage, AnchoredValues>;

public:
    /// With `balanced`, no leaf ever has a neighbour across a face that is more than one level
    /// coarser (octrees).
    explicit TreeData(const SpaceOptions& options, bool balanced = false)
        : options_(options), balanced_(balanced), topology_(options.domain), storage_(options) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const {
        sample_leaves(topology_, storage_, x, out);
    }

    InsertionReport insert(std::span<const PointSource> sources) {
        // Copying everything would be out of proportion to a few sources more.
        is_finished_ = options_.takes_later_sources;
        InsertionReport report;
        if constexpr (Storage::grows_by_leaf) {
            if (!balanced_ && !storage_.keeps_asked()) report = insert_by_leaf(sources);
        }
        insert_in_turn(sources, report);
        if (!is_finished_ && sources.size() > topology_.leaves() / 16) finish();
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        return storage_.control_nodes(topology_, neighbourhood);
    }
    void assign(std::span<const Metric> metrics) requires(!keeps_sources) {
        require_one_each(metrics.size(), storage_.control_nodes_of(topology_));
        storage_.assign(topology_, metrics);
        past_.reset();
    }

    GradationReport grade(const GradationOptions& options) {
        if constexpr (keeps_sources) {
            return grade_sources(options);
        } else {
            require_valid(options);
            if (options.neighbourhood == Neighbourhood::all) {
                require_memory(topology_.leaves(), options.neighbourhood);
            }
            topology_.fit_jumps();
            return options_.takes_later_sources ? grade_beside_asked(options)
                                                : storage_.grade(topology_, options);
        }
    }

    AdaptationReport adapt(const AdaptationGoal& goal) {
        const GoalField field(goal, domain());
        topology_ = Topology<Node>(domain());
        storage_ = Storage(options_);
        past_.reset();
        if constexpr (keeps_sources) storage_.take_over(goal);
        AdaptationReport report;
        bool too_deep = false;
        bool too_short = false;
        TreeAdaptation adaptation(topology_, storage_, field, goal);
        report.reached = adaptation.run(true, [&](const Box& box, const auto& along, auto& cut) {
            if (is_negligible(box)) {
                too_short = true;
                return false;
            }
            const bool done = split_across(box, along, cut);
            too_deep = too_deep || !done;
            return done;
        });
        report.met = report.reached <= goal.target;
        if (too_deep) {
            report.shortfall =
                fmt::format("leaves of level {} are not cut: raise target_delta or the depth",
                            cuts().max_depth());
        } else if (too_short) {
            report.shortfall =
                "the field jumps: leaves far shorter than an element are not cut: raise "
                "target_delta";
        }
        finish();
        return report;
    }

    void save(StateWriter& state) const {
        controlspace::save(topology_, state);
        storage_.save(state);
        exchange_past(past_, state);
    }
    void load(const StateReader& state) {
        is_finished_ = true;
        topology_ = load_topology<Node>(domain(), state);
        storage_.load(topology_, state);
        exchange_past(past_, state);
    }

    const Box& domain() const { return topology_.domain(); }

    Footprint footprint() const {
        Footprint footprint;
        topology_.describe(footprint);
        storage_.describe(footprint);
        footprint.bytes_published =
            published_bytes({is_octree, !std::is_base_of_v<LeafValues, Storage>, topology_.leaves(),
                             topology_.inner_nodes(), footprint.control_nodes});
        return footprint;
    }

    Box cell_at(const Point& x) const { return topology_.locate(x).box; }

    std::unique_ptr<ControlSpace> pack(Precision precision) const requires(!keeps_sources) {
        return storage_.freeze(topology_, precision);
    }
    static std::unique_ptr<ControlSpace> load_compact(
        const Box& domain, Precision precision, const StateReader& state) requires(!keeps_sources) {
        return load_frozen(domain, precision, state);
    }

    bool is_finished() const { return is_finished_; }
    /// Gives back what only growing needs, and makes what only answers need.
    void finish() {
        if constexpr (keeps_sources) storage_.drop_idle_sources();
        topology_.shrink_to_fit();
        topology_.fit_jumps();
        storage_.shrink_to_fit();
        if constexpr (requires { storage_.remember_parts(topology_); }) {
            storage_.remember_parts(topology_);
        }
        is_finished_ = true;
    }

private:
    static constexpr bool is_octree = std::is_same_v<Node, OctreeNode>;

    SourceCuts<Node> cuts() const { return SourceCuts<Node>(options_); }

    InsertionReport insert_by_leaf(std::span<const PointSource> sources) {
        InsertionReport report;
        const SourceCuts<Node> cuts = this->cuts();
        LeafGrowth<Node> growth(cuts, options_.tolerance);
        while (report.sources < sources.size()) {
            const auto batch = growth.next_batch(sources.subspan(report.sources));
            const std::size_t valid = growth.grow(topology_, storage_.metrics(), batch);
            if (valid == 0) require_valid(batch.front(), report.sources, domain());
            make_room_for(growth.cuts_made());
            topology_.grow(growth.cuts_made());
            storage_.grow(growth.cuts_made() * (Node::arity - 1));
            growth.enter(topology_, storage_.metrics());
            topology_.fit_jumps_roughly();
            report.sources += valid;
            report.inserted += growth.inserted();
        }
        return report;
    }

    // One after the other, those left after the report's.
    void insert_in_turn(std::span<const PointSource> sources, InsertionReport& report) {
        MetSources met;
        while (report.sources < sources.size()) {
            const auto part = met.next_part(sources.subspan(report.sources));
            if constexpr (!keeps_sources) {
                met.look(topology_, storage_, options_.tolerance, part);
            }
            for (std::size_t k = 0; k < part.size(); ++k, ++report.sources) {
                if (met.is_met(k)) continue;
                require_valid(part[k], report.sources, domain());
                if (insert_valid(part[k]) == Insertion::inserted) ++report.inserted;
            }
        }
    }

    Insertion insert_valid(const PointSource& source) {
        const Point& q = source.position;
        if (!calls_for_change(source.metric, storage_.asked(topology_, q), options_.tolerance)) {
            return Insertion::already_met;
        }
        LeafPlace place = topology_.locate(q);
        while (const auto cut = cuts().cut(place, source)) {
            split(place, *cut);
            place = topology_.locate_from(place, q);
        }
        storage_.lower(place, source);
        return Insertion::inserted;
    }

    // Grades what the sources ask for, which stays beside the field; where little has changed, that
    // alone.
    GradationReport grade_beside_asked(const GradationOptions& options) {
        require_valid(options);
        GradationReport report;
        if (may_regrade(past_, options) && storage_.is_regradable()) {
            report = storage_.regrade(topology_, *past_);
        } else {
            std::vector<Metric> asked = storage_.release_asked();
            report = storage_.grade(topology_, options);
            storage_.keep_asked(std::move(asked));
        }
        past_ = {options, report.largest_ratio_left};
        return report;
    }

    // Looks up which sources govern the leaves. On the way leaves where three and more do are cut,
    // down to l_min in their own metric.
    GradationReport grade_sources(const GradationOptions& options) {
        controlspace::require_valid(options);
        constexpr double close = 0.02;  // non-conformity to the exact field
        const std::vector<PointSource> sources = storage_.sources().all();
        const AdaptationGoal goal{sources, storage_.continuous(), options.ratio, close};
        const GoalField field(goal, domain());
        storage_.take_over(goal);
        GradationReport report;
        TreeAdaptation adaptation(topology_, storage_, field, goal);
        adaptation.run(false, [&](const Box& box, const auto& along, auto& cut) {
            ++report.operations;
            return cuts().is_too_long(storage_.value(topology_, box.centre()), box) &&
                   split_across(box, along, cut);
        });
        finish();
        const ControlNodes nodes = control_nodes(Neighbourhood::faces);
        report.largest_ratio_left =
            largest_gradation(nodes.graph, nodes.metrics, GradationLaw::cone);
        return report;
    }

    // Cuts the leaf with this box where something varies by `along` the axes, unless it is among
    // the smallest allowed.
    bool split_across(const Box& box, const std::array<double, 3>& along,
                      std::vector<LeafIndex>& cut) {
        const LeafPlace place = topology_.locate(box.centre());
        const Subdivision subdivision = Node::subdivision_across(place.box, along);
        if (place.level >= cuts().max_depth() || !subdivision.is_proper()) return false;
        split(place, subdivision, &cut);
        return true;
    }

    // Whether no mesh could tell one end of the box from the other. Fields may jump: what tensors
    // make of each other depends on which is the smallest.
    bool is_negligible(const Box& box) const {
        constexpr double share_of_element = 1.0 / 16;
        const Metric m = storage_.value(topology_, box.centre());
        const auto lengths = metric_edge_lengths(m, box.edges());
        return std::max({lengths[0], lengths[1], lengths[2]}) < share_of_element;
    }

    // Appends to `cut`, if given, the leaf and all neighbours that had to be split before it.
    void split(const LeafPlace& place, const Subdivision& subdivision,
               std::vector<LeafIndex>* cut = nullptr) {
        make_room_for(1);
        if constexpr (is_octree) {
            if (balanced_) refine_coarser_neighbours(place, cut);
        }
        const auto first_new = static_cast<LeafIndex>(topology_.leaves());
        topology_.split(place, subdivision);
        topology_.fit_jumps_roughly();
        storage_.split(subdivision, place.leaf, first_new);
        if (cut != nullptr) cut->push_back(place.leaf);
    }

    // Throws InputError where the tree is not to have so many inner nodes more.
    void make_room_for(std::size_t cuts) {
        if (topology_.is_full(cuts)) {
            throw InputError("a tree holds 2^30 leaves at most: raise l_min or lower the depth");
        }
        const std::size_t leaves = topology_.leaves() + cuts * (Node::arity - 1);
        if (leaves > next_look_) require_memory(leaves);
    }

    // Stops a tree of so many leaves that outgrows the cap, long before the system stops the
    // program.
    void require_memory(std::size_t leaves, Neighbourhood neighbourhood = Neighbourhood::faces) {
        // Gradation copies the nodes and links them: over faces 145 bytes for a leaf, 290 for its
        // vertices; with all neighbours up to 640.
        const std::size_t gradation_bytes_per_leaf =
            neighbourhood == Neighbourhood::all ? 700 : 300;
        const std::size_t bytes = footprint().bytes_total() + leaves * gradation_bytes_per_leaf;
        if (bytes > options_.max_bytes) {
            constexpr double gib = 1024.0 * 1024 * 1024;
            throw InputError(
                fmt::format("the tree would take more than {:.3g} GiB, gradation included: raise "
                            "tau (l_min) or target_delta, "
                            "or max_memory",
                            static_cast<double>(options_.max_bytes) / gib));
        }
        next_look_ = leaves + leaves / 16;
    }

    // Brings all face neighbours to the leaf's own level at least, so that it may be split.
    void refine_coarser_neighbours(const LeafPlace& place, std::vector<LeafIndex>* cut) {
        for (int face = 0; face < 6; ++face) {
            LeafPlace neighbour;
            if (!locate_across(topology_, place.box, face, place.box.centre(), neighbour)) continue;
            if (neighbour.level < place.level) split(neighbour, octants(neighbour.box), cut);
        }
    }

    SpaceOptions options_;
    bool balanced_;
    Topology<Node> topology_;
    Storage storage_;
    std::optional<PastGradation> past_;  // where sources may come after it
    bool is_finished_ = false;           // nothing has grown since `finish`
    std::size_t next_look_ = 1024;       // number of leaves at which memory is looked at again
};

}  // namespace controlspace
