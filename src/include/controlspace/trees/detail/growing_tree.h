// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/detail/adapt_tree.h"
#include "controlspace/trees/detail/adjacency.h"
#include "controlspace/trees/detail/sample_leaves.h"
#include "controlspace/trees/detail/source_cuts.h"
#include "controlspace/trees/detail/storage_state.h"
#include "controlspace/trees/detail/topology_state.h"
#include "controlspace/trees/storage.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

[[noreturn]] void fail_too_many_leaves();
[[noreturn]] void fail_too_large(std::size_t bytes, std::size_t max_bytes);
/// AdaptationReport::shortfall where leaves of a level are not cut, which no depth may exceed if it
/// is the `deepest`.
std::string depth_shortfall(int max_depth, int deepest);
/// The same where there are as many leaves as allowed.
std::string leaves_shortfall(std::size_t max_leaves);
/// The same at a limit of time or memory.
std::string limit_shortfall(GrowthStop stop);
[[noreturn]] void fail_stopped(GrowthStop stop, std::size_t leaves);

/// A tree over a box whose leaves are cut, for sources or to follow a field: what MetricTree and
/// SourceTree share. `Node` is how a box is cut, `Storage` what leaves hold (storage.h).
template <class Node, class Storage>
class GrowingTree {
public:
    void sample(std::span<const Point> x, std::span<Metric> out) const {
        sample_leaves(topology_, field_of(storage_), x, out);
    }
    Metric metric_at(const Point& x) const { return value_at(topology_, field_of(storage_), x); }
    const Box& domain() const { return topology_.domain(); }
    const SpaceOptions& options() const { return options_; }
    Box cell_at(const Point& x) const { return topology_.locate(x).box; }
    Footprint footprint() const {
        Footprint footprint;
        topology_.describe(footprint);
        describe_storage(storage_, footprint);
        return footprint;
    }

    bool is_finished() const { return is_finished_; }

protected:
    /// With `balanced`, no leaf has a neighbour across a face that is more than one level coarser
    /// (octrees).
    explicit GrowingTree(const SpaceOptions& options, bool balanced)
        : options_(options), balanced_(balanced), topology_(options.domain), storage_(options) {
        check_storage<Storage>();
    }

    SourceCuts<Node> cuts() const { return SourceCuts<Node>(options_, deepest_); }

    /// Empties the tree and cuts it until it follows the field; `begin` may prepare the storage.
    template <class Begin>
    AdaptationReport adapt(const AdaptationGoal& goal, Begin&& begin) {
        constexpr std::size_t bytes_of_adaptation = 240;  // for each leaf
        const GoalField field(goal, domain(), GoalField::many_answers,
                              GoalField::Thinning::allowed);
        bytes_to_come_ = bytes_of_adaptation;
        next_check_ = 0;
        is_adapted_ = true;
        outgrows_ = false;
        topology_ = Topology<Node>(domain());
        storage_ = Storage(options_);
        begin();
        AdaptationReport report;
        bool too_deep = false;
        bool too_short = false;
        GrowthStop stop = GrowthStop::none;
        TreeAdaptation adaptation(topology_, storage_, field, goal, options_.growth);
        report.reached = adaptation.run(true, [&](const Box& box, const auto& along, auto& cut) {
            const bool is_full = topology_.leaves() + more_by_brick() >= goal.max_leaves;
            stop = is_full ? GrowthStop::leaves : growth_stop();
            if (stop != GrowthStop::none) return false;
            if (is_negligible(box, field.largest_ratio())) {
                too_short = true;
                return false;
            }
            const bool done = split_across(box, along, cut);
            too_deep = too_deep || !done;
            return done;
        });
        bytes_to_come_ = 0;
        is_adapted_ = false;
        if (adaptation.is_late()) stop = GrowthStop::time;
        report.met = report.reached <= field.target();
        report.reached = field.departure_from_all(report.reached);
        report.is_bound = report.met && adaptation.shows_bounds();
        if (report.met) {
            // Leaves that were not cut may be just below the target.
        } else if (stop != GrowthStop::none) {
            report.stop = stop;
            report.shortfall = stop == GrowthStop::leaves ? leaves_shortfall(goal.max_leaves)
                                                          : limit_shortfall(stop);
        } else if (too_deep) {
            report.shortfall = depth_shortfall(max_depth(), deepest_);
        } else if (too_short) {
            report.shortfall =
                "the field is steep: leaves far shorter than an element are not cut: raise "
                "target_delta";
        }
        return report;
    }

    /// Cuts the leaf that holds the source until it is short enough. Returns its place.
    LeafPlace cut_for(const PointSource& source) {
        LeafPlace place = topology_.locate(source.position);
        while (const auto cut = cuts().cut(place, source)) {
            split(place, *cut, nullptr);
            place = topology_.locate_from(place, source.position);
        }
        return place;
    }

    /// The deepest level of leaves that are cut for anything but a source.
    int max_depth() const {
        const auto& depth = Node::is_octant ? options_.octree_depth : options_.kd_depth;
        return std::min(depth.value_or(deepest_), deepest_);
    }

    /// Cuts the leaf with this box where something varies by `along` the axes, unless it is among
    /// the smallest allowed.
    bool split_across(const Box& box, const std::array<double, 3>& along,
                      std::vector<LeafIndex>& cut) {
        const LeafPlace place = topology_.locate(box.centre());
        const Subdivision subdivision =
            Node::subdivision_across(domain(), place.level, place.box, along);
        if (place.level >= max_depth() || !subdivision.is_proper()) return false;
        split(place, subdivision, &cut);
        return true;
    }

    /// Appends to `cut`, if given, the leaf and all others that had to be split before it or with
    /// it.
    void split(const LeafPlace& place, const Subdivision& subdivision,
               std::vector<LeafIndex>* cut) {
        if (brick_levels_ > 0) return split_brick(place, cut);
        make_room_for(Node::arity - 1);
        if (balanced_) refine_coarser_neighbours(place, cut);
        split_alone(place, subdivision, cut);
    }

    /// Splits leaves until none has a neighbour across a face that is more than one level coarser:
    /// the least such tree, whatever the order.
    void balance() {
        std::vector<LeafPlace> inner;
        list_inner({topology_.root(), domain()}, 0, inner);
        for (const LeafPlace& place : inner) refine_coarser_neighbours(place, nullptr);
    }

    /// Splits leaves until those of each brick are of one level: the least such tree. Only the
    /// topology is changed; repeat(leaf, times) copies what else there is for a leaf.
    template <class Repeat>
    void complete_bricks(const Repeat& repeat) {
        const std::vector<std::uint8_t> levels = topology_.levels_below();
        struct Coarse {
            Point inside;
            int level;  // that it, or its parts, are to have
        };
        std::vector<Coarse> coarse;
        const auto list = [&](const auto& self, const TreePart& part, int level) -> void {
            const int below = part.ref.is_leaf() ? 0 : levels[part.ref.index()];
            if (below > brick_levels_) {
                topology_.for_each_child(
                    part, [&](const TreePart& child) { self(self, child, level + 1); });
                return;
            }
            // The domain itself may be a brick of fewer levels.
            const int least = level == 0 ? below : level + brick_levels_;
            topology_.for_each_leaf_in(part, [&](LeafIndex, const Box& box) {
                coarse.push_back({box.centre(), least});
            });
        };
        list(list, {topology_.root(), domain()}, 0);
        const auto deepen = [&](const auto& self, const Point& inside, int least) -> void {
            const LeafPlace place = topology_.locate(inside);
            const Subdivision parts = Node::even_subdivision(domain(), place.level, place.box);
            if (place.level >= least || !parts.is_proper()) return;
            make_room_for(Node::arity - 1);
            topology_.split(place, parts);
            topology_.fit_jumps_roughly();
            repeat(place.leaf, static_cast<std::size_t>(parts.children() - 1));
            for (int c = 0; c < parts.children(); ++c) self(self, parts.child(c).centre(), least);
        };
        for (const Coarse& leaf : coarse) deepen(deepen, leaf.inside, leaf.level);
    }

    /// Throws InputError where the tree is not to have so many leaves more.
    void make_room_for(std::size_t more) {
        if (topology_.is_full(more)) fail_too_many_leaves();
        const std::size_t leaves = topology_.leaves() + more;
        if (leaves <= next_check_) return;
        require_memory(leaves);
        // Adaptation ends between leaves.
        if (!is_adapted_) require_may_grow();
    }
    /// Throws GrowthStopped at a limit of time or memory.
    void require_may_grow() const {
        const GrowthStop stop = growth_stop();
        if (stop != GrowthStop::none) fail_stopped(stop, topology_.leaves());
    }

    /// Stops a tree of so many leaves that outgrows the cap, long before the system stops the
    /// program.
    void require_memory(std::size_t leaves) {
        // While an array grows, and while the finished tree is compared and packed.
        constexpr std::size_t bytes_beside = 64;
        const std::size_t bytes = footprint().bytes_total();
        require_bytes(bytes + std::min(bytes, most_bytes_twice) + bytes_aside_ +
                      leaves * (bytes_beside + bytes_to_come_));
        outgrows_ = bytes > options_.growth.bytes;
        next_check_ = leaves + leaves / 16;
    }
    /// The same of gradation from node to node, which copies the nodes and links them.
    void require_memory_to_grade(Neighbourhood neighbourhood) const {
        // Over faces 145 bytes for a leaf, 290 for its vertices; with all neighbours up to 640.
        const std::size_t bytes_per_leaf = neighbourhood == Neighbourhood::all ? 700 : 300;
        require_bytes(footprint().bytes_total() + topology_.leaves() * bytes_per_leaf);
    }

    /// Gives back what only growing needs, and makes what only answers need.
    void settle() {
        topology_.shrink_to_fit();
        topology_.fit_jumps();
        shrink_storage(storage_);
        if constexpr (requires { storage_.prepare(topology_); }) storage_.prepare(topology_);
        is_finished_ = true;
    }

    // Whether the box is far shorter than an element, and the field of this ratio varies little in
    // it. Fields may be steep: the intersection of tensors in turn depends on which is the
    // smallest.
    bool is_negligible(const Box& box, double ratio) const {
        constexpr double usual_slope = 0.25;
        const double share_of_element = 1.0 / 16 * (usual_slope / std::max(usual_slope, ratio - 1));
        const Metric m = value_at(topology_, field_of(storage_), box.centre());
        const auto lengths = metric_edge_lengths(m, box.edges());
        return std::max({lengths[0], lengths[1], lengths[2]}) < share_of_element;
    }

    SpaceOptions options_;
    int deepest_ = deepest_level<Node>;  // of what the storage or a finished form can hold
    bool balanced_;
    /// If positive, leaves are cut together with all that have the same ancestor so many levels
    /// above: they make bricks of (2^levels)^3 leaves of one size. The first levels are cut all
    /// over.
    int brick_levels_ = 0;
    Topology<Node> topology_;
    Storage storage_;
    bool is_finished_ = false;       // nothing has grown since `settle`
    std::size_t bytes_to_come_ = 0;  // for each leaf, beside what it takes already
    std::size_t bytes_aside_ = 0;    // of what is to be entered into the tree

private:
    void split_alone(const LeafPlace& place, const Subdivision& subdivision,
                     std::vector<LeafIndex>* cut) {
        const auto first_new = static_cast<LeafIndex>(topology_.leaves());
        topology_.split(place, subdivision);
        topology_.fit_jumps_roughly();
        storage_.split(subdivision, place.leaf, first_new);
        if (cut != nullptr) cut->push_back(place.leaf);
    }
    void split_brick(const LeafPlace& place, std::vector<LeafIndex>* cut) {
        TreePart brick{topology_.root(), domain()};
        for (int level = 0; level + brick_levels_ < place.level; ++level) {
            const std::size_t slot =
                topology_.node(brick.ref).descend(place.box.centre(), brick.box);
            brick.ref = topology_.node(brick.ref).children[slot];
        }
        std::vector<Point> inside;
        topology_.for_each_leaf_in(
            brick, [&](LeafIndex, const Box& box) { inside.push_back(box.centre()); });
        make_room_for(inside.size() * (Node::arity - 1));
        for (const Point& x : inside) {
            const LeafPlace leaf = topology_.locate(x);
            const Subdivision parts = Node::even_subdivision(domain(), leaf.level, leaf.box);
            if (parts.is_proper()) split_alone(leaf, parts, cut);
        }
    }

    // How many leaves a cut adds beside those of a single leaf, at most.
    std::size_t more_by_brick() const {
        const std::size_t of_brick = std::size_t{1} << 3 * brick_levels_;
        return (std::min(of_brick, topology_.leaves()) - 1) * (Node::arity - 1);
    }
    GrowthStop growth_stop() const {
        if (outgrows_) return GrowthStop::memory;
        return options_.growth.is_late() ? GrowthStop::time : GrowthStop::none;
    }
    void require_bytes(std::size_t bytes) const {
        if (bytes > options_.max_bytes) fail_too_large(bytes, options_.max_bytes);
    }
    // Those below a part, with it.
    void list_inner(const TreePart& part, int level, std::vector<LeafPlace>& inner) const {
        if (part.ref.is_leaf()) return;
        LeafPlace& place = inner.emplace_back();
        place.box = part.box;
        place.level = level;
        topology_.for_each_child(
            part, [&](const TreePart& child) { list_inner(child, level + 1, inner); });
    }
    // Brings all face neighbours to the level of a leaf or inner node at least, so that it may be
    // split.
    void refine_coarser_neighbours(const LeafPlace& place, std::vector<LeafIndex>* cut) {
        for (int face = 0; face < 6; ++face) {
            LeafPlace neighbour;
            while (locate_across(topology_, place.box, face, place.box.centre(), neighbour) &&
                   neighbour.level < place.level) {
                split(neighbour, Node::even_subdivision(domain(), neighbour.level, neighbour.box),
                      cut);
            }
        }
    }

    std::size_t next_check_ = 0;  // number of leaves at which memory is checked again
    bool outgrows_ = false;       // its limit of memory, when it was checked last
    bool is_adapted_ = false;     // at this moment
};

}  // namespace controlspace
