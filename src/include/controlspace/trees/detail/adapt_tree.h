// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/space/sample_parallel.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/detail/control_nodes.h"
#include "controlspace/trees/detail/in_parallel.h"
#include "controlspace/trees/detail/leaf_judge.h"
#include "controlspace/trees/detail/nearby_field.h"
#include "controlspace/trees/detail/next_to_sources.h"
#include "controlspace/trees/detail/sample_leaves.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// Splits leaves of a tree, which should consist of its root, until each is within the target of
/// the field wherever it is sampled.
template <class Node, class Storage>
class TreeAdaptation {
public:
    TreeAdaptation(const Topology<Node>& tree, Storage& storage, const GoalField& field,
                   const AdaptationGoal& goal, const GrowthLimit& limit = {})
        : tree_(tree),
          storage_(storage),
          field_(field),
          aim_(field.target()),
          max_leaves_(goal.max_leaves),
          limit_(limit),
          next_to_sources_(tree, storage, field, goal.sources) {
        if (field.has_ranges()) {
            for (const std::uint32_t i : field.kept()) {
                sources_.push_back(goal.sources[i].position);
            }
        } else {
            for (const PointSource& source : goal.sources) sources_.push_back(source.position);
            std::ranges::copy_if(goal.places, std::back_inserter(sources_),
                                 [&](const Point& x) { return tree.domain().contains(x); });
        }
        at_sources_.resize(sources_.size());
        sample_parallel(field, sources_, at_sources_);
        leaf_of_source_.resize(sources_.size(), 0);
    }

    /// `split(box, along, cut)` cuts the leaf with that box, across an axis for which `along`
    /// speaks most, and appends to `cut` the numbers of all leaves that it had to cut; it returns
    /// false where the leaf must stay as it is.
    ///
    /// Leaves are sampled in their LeafPlaces; if `proved`, those that pass also at other places.
    /// Leaves above the target, or just below it where no bound is known, are fitted anew or cut,
    /// and sampled again. Returns the largest departure that is left; infinite if some leaf was not
    /// to be cut, and neither shown to keep the target nor found to exceed it.
    template <class Split>
    double run(bool proved, Split&& split) {
        // A peak is rarely found to its very top.
        const bool are_few = field_.has_few_sources();
        const double share_where_sampled = are_few ? 0.96 : 0.99;
        // Leaves of kd-trees may be long along axes where a continuous field hardly changes; those
        // of octrees are small, and many.
        const bool is_known = field_.is_order_free() || field_.has_ranges();
        is_thorough_ = proved && !shows_bounds() &&
                       (are_few || is_known || (Node::arity == 2 && !field_.jumps()));
        if (is_thorough_) aim_ = share_where_sampled * field_.target();
        states_.assign(tree_.leaves(), LeafState::fresh);
        departures_.resize(tree_.leaves());
        while (round(proved, split)) {
        }
        if constexpr (follows_neighbours<Storage>()) {
            // Neighbours may have been cut after a leaf was sampled.
            constexpr int rounds_of_all = 2;
            for (int k = 0; proved && !is_late_ && k < rounds_of_all; ++k) {
                states_.assign(tree_.leaves(), LeafState::changed);
                while (round(proved, split)) {
                }
            }
        }
        double left = 0;
        for (const Departure& d : departures_) left = std::max(left, d.worst);
        return left;
    }

    /// Whether it ended at the deadline. Leaves that were not sampled depart without bound then.
    bool is_late() const { return is_late_; }

    /// Whether a target that is met is shown by bounds to be kept everywhere.
    bool shows_bounds() const {
        return covers() || has_bounds() || (HasConstantLeaves<Storage> && field_.has_ranges());
    }

private:
    enum class LeafState : std::uint8_t { settled, changed, fresh };
    // Whether the storage can improve a leaf that departs from the field without cutting it. What
    // costs little is done before it is necessary.
    static constexpr bool learns() {
        return requires(Storage & s) { s.learn(LeafIndex{}, std::vector<std::uint32_t>()); };
    }
    static constexpr double share_where_learned = 0.7;
    // In gradation, each of few tensors is compared with each leaf: cuts until all of them are met
    // would make as many leaves as the cube of their number.
    bool learns_before_cuts() const {
        return (field_.is_order_free() || field_.jumps()) &&
               field_.has_sources_up_to(NextToSources<Node, Storage>::few);
    }
    static constexpr double far_off = 10;

    // Samples the leaves that are not settled, and settles, fits or cuts them. Returns
    // whether some have to be sampled again.
    template <class Split>
    bool round(bool proved, Split&& split) {
        field_.forget_if_full();
        if constexpr (learns()) lessons_.assign(tree_.leaves(), {});
        std::vector<LeafBox> young = leaves_in_state(LeafState::changed);
        if (proved && covers()) {
            cover(young);
        } else {
            const std::vector<LeafBox> fresh = leaves_in_state(LeafState::fresh);
            evaluate_shared_places(fresh);
            fit(fresh, proved);
            sample(young, proved);
        }
        for (const LeafBox& l : young) states_[l.leaf] = LeafState::settled;
        is_late_ = limit_.is_late();
        if (is_late_) return false;
        if (tree_.leaves() + Node::arity * young.size() > max_leaves_) {
            std::ranges::stable_sort(young, std::greater(),
                                     [&](const LeafBox& l) { return departures_[l.leaf].worst; });
        }
        bool changes = false;
        std::vector<LeafIndex> cut;
        for (const LeafBox& l : young) {
            // It may have been cut to make way for a neighbour.
            if (states_[l.leaf] != LeafState::settled) continue;
            Departure& departure = departures_[l.leaf];
            if constexpr (learns()) {
                if (!lessons_[l.leaf].empty()) {
                    storage_.learn(l.leaf, lessons_[l.leaf]);
                    states_[l.leaf] = LeafState::changed;
                    changes = true;
                    continue;
                }
            }
            if (!(departure.worst > aim_)) continue;
            cut.clear();
            const bool is_cut = split(l.box, departure.along, cut);
            changes = is_cut || changes;
            if constexpr (learns()) {
                // What is too short to be cut, and far off beside a steep cone.
                if (!proved && !is_cut && departure.worst > far_off * aim_) {
                    NearbyField nearby(field_);
                    nearby.enter(l.box, true);
                    const auto lesson = storage_.lesson(l.leaf, departure.where, nearby, field_);
                    if (!lesson.empty()) {
                        storage_.learn(l.leaf, lesson);
                        states_[l.leaf] = LeafState::changed;
                        changes = true;
                        continue;
                    }
                }
            }
            if (!is_cut && departure.is_unknown() && !limit_.is_late()) {
                const Departure found = at_some_places(l);
                if (found.worst > field_.target()) departure = found;
            }
            departures_.resize(tree_.leaves());
            states_.resize(tree_.leaves(), LeafState::fresh);
            for (const LeafIndex leaf : cut) states_[leaf] = LeafState::fresh;
        }
        return changes;
    }

    // Where leaves will be compared with the field, as far as they share the places.
    void evaluate_shared_places(const std::vector<LeafBox>& leaves) const {
        if constexpr (!requires { storage_.is_fitted(LeafIndex{}); }) {
            constexpr auto ranges = LeafJudge<Node, Storage>::ranges();
            for (std::size_t r = 0; r < LeafJudge<Node, Storage>::shared_ranges; ++r) {
                evaluate_shared(field_, leaves, ranges[r].from, ranges[r].to);
            }
        }
    }

    void fit(const std::vector<LeafBox>& leaves, bool proved) {
        if constexpr (requires { storage_.fit(tree_, leaves, field_, proved); }) {
            storage_.fit(tree_, leaves, field_, proved);
        } else if constexpr (requires { storage_.fit(leaves[0], field_); }) {
            in_parallel(leaves.size(), [&](std::size_t i) { storage_.fit(leaves[i], field_); });
        } else {
            // Constant leaves are set by the bounds of the field in them, where these are known.
            if (HasConstantLeaves<Storage> && field_.has_ranges()) return;
            fit_nodes(storage_, leaves, field_);
        }
        if constexpr (requires { storage_.graded(field_.largest_ratio()); }) {
            storage_.graded(field_.largest_ratio());
        }
    }

    // Whether what the storage answers at the leaf's own places is known to follow the field.
    bool is_fitted(LeafIndex leaf) const {
        if constexpr (requires { storage_.is_fitted(leaf); }) return storage_.is_fitted(leaf);
        return false;
    }

    // Whether the storage can be brought to keep the target everywhere in a leaf.
    bool covers() const {
        if constexpr (requires { &Storage::cover; }) return field_.has_ranges();
        return false;
    }

    // Whether bounds can show that leaves keep the target everywhere.
    bool has_bounds() const {
        return HasTrilinearLeaves<Storage> && field_.has_ranges() && !sources_.empty();
    }

    // Leaves that cannot be brought to that depart without bound, as far as is known.
    void cover(std::span<const LeafBox> leaves) {
        if constexpr (requires { &Storage::cover; }) {
            std::vector<std::uint8_t> is_kept(leaves.size(), 0);
            storage_.cover(leaves, field_, is_kept);
            constexpr double infinity = std::numeric_limits<double>::infinity();
            const double most_kept = sources_.empty() ? 0 : field_.target();
            for (std::size_t i = 0; i < leaves.size(); ++i) {
                departures_[leaves[i].leaf] = {};
                departures_[leaves[i].leaf].worst = is_kept[i] != 0 ? most_kept : infinity;
            }
        }
    }

    Departure at_some_places(const LeafBox& leaf) const {
        constexpr std::uint64_t places = 64;
        NearbyField nearby(field_);
        nearby.enter(leaf.box, true);
        Findings found(leaf);
        LeafJudge<Node, Storage>(tree_, storage_, aim_).at_sequence(leaf, nearby, 0, places, found);
        return found.departure;
    }

    // Those in this state, or in a later one.
    std::vector<LeafBox> leaves_in_state(LeafState least) const {
        std::vector<LeafBox> leaves;
        tree_.for_each_leaf([&](LeafIndex leaf, const Box& box) {
            if (states_[leaf] >= least) leaves.push_back({leaf, box});
        });
        return leaves;
    }

    // At their own places, if fresh, and, if `proved`, at places that no leaf has been fitted to:
    // some in each leaf, more in a large one, and the more the closer the target.
    void sample(std::span<const LeafBox> leaves, bool proved) {
        const double places_in_domain = std::min(5e3 / field_.target(), 1e7);
        constexpr std::uint64_t places_at_least = 16;
        const double whole = measure(tree_.domain());
        std::vector<std::uint64_t> first(leaves.size() + 1, places_used_);
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const double share = measure(leaves[i].box) / whole;
            first[i + 1] =
                first[i] + places_at_least + static_cast<std::uint64_t>(share * places_in_domain);
        }
        places_used_ = first.back();
        for (const LeafBox& l : leaves) departures_[l.leaf] = {};
        const LeafJudge judge(tree_, storage_, aim_);
        if constexpr (HasConstantLeaves<Storage>) {
            if (field_.has_ranges()) {
                fit_to_ranges(leaves, judge);
                return;
            }
        }
        sample_sources();
        const bool is_sampled = !has_bounds();
        if (is_sampled) {
            const auto is_new = [&](LeafIndex leaf) { return states_[leaf] != LeafState::settled; };
            next_to_sources_.find_beside(is_new, [&](LeafIndex leaf) {
                return is_new(leaf) && !(departures_[leaf].worst > aim_);
            });
        }
        in_parallel(leaves.size(), [&, nearby = NearbyField(field_)](std::size_t i) mutable {
            const LeafBox& l = leaves[i];
            if (limit_.is_late()) {
                departures_[l.leaf].worst = std::numeric_limits<double>::infinity();
                return;
            }
            nearby.enter(l.box, true);
            Findings found(l);
            Departure& departure = found.departure;
            if (departures_[l.leaf].worst > 0) {
                found.take(departures_[l.leaf].worst, departures_[l.leaf].where);
            }
            const auto is_bad = [&] { return departure.worst > aim_; };
            const bool needs_axis = Node::arity == 2;
            // First: where it shows that the target is kept, nothing else is needed.
            std::optional<Departure> bound;
            if constexpr (HasTrilinearLeaves<Storage>) {
                if (proved && !is_sampled && !is_bad()) bound = judge.everywhere(l, nearby);
            }
            const bool is_kept = bound && !(bound->worst > aim_);
            if (states_[l.leaf] == LeafState::fresh && !is_kept && !is_fitted(l.leaf) &&
                (needs_axis || !is_bad())) {
                judge.at_places_of(l, nearby, found);
            }
            if (is_sampled && !is_bad()) {
                std::vector<Point> further;
                const Departure estimate = next_to_sources_.worst_in(l, further);
                judge.examine(l, nearby, estimate, further, found);
            }
            if (proved && !is_bad()) {
                if (bound) departure.take(bound->worst, bound->where);
                if (is_sampled) search(l, judge, nearby, first[i], first[i + 1], found);
            }
            departures_[l.leaf] = departure;
            if constexpr (learns()) {
                if (departure.worst > (proved ? share_where_learned : 1) * aim_ &&
                    (proved || learns_before_cuts())) {
                    lessons_[l.leaf] = storage_.lesson(l.leaf, departure.where, nearby, field_);
                }
            }
        });
    }

    // For the worst place of a leaf that seems to be within the target.
    void search(const LeafBox& l, const LeafJudge<Node, Storage>& judge, NearbyField& nearby,
                std::uint64_t first, std::uint64_t end, Findings& found) const {
        constexpr std::uint64_t more = 32;
        judge.at_sequence(l, nearby, first, end, found);
        const auto is_near = [&](double share) {
            const double worst = found.departure.worst;
            return is_thorough_ && worst > share * aim_ && !(worst > aim_);
        };
        const double slope = field_.largest_ratio() - 1;
        // Where the field has a crease across an edge, the middle of that shows little of it.
        if (is_near(0.5)) judge.at_places_between(l, nearby, found);
        if constexpr (HasTrilinearLeaves<Storage>) {
            if (is_near(0)) judge.along_edges(l, nearby, slope, found);
        }
        if (is_near(0.7)) judge.at_sequence(l, nearby, end, end + more, found);
        judge.climb(l, nearby, slope, is_thorough_, found);
    }

    // Sets leaves of a constant value to what is between the bounds of the field in them. Bounds
    // hold everywhere in the leaf: nothing is sampled.
    void fit_to_ranges(std::span<const LeafBox> leaves, const LeafJudge<Node, Storage>& judge) {
        in_parallel(leaves.size(), [&, nearby = NearbyField(field_)](std::size_t i) mutable {
            const LeafBox& l = leaves[i];
            nearby.enter(l.box, false);
            const auto [least, most] = nearby.range();
            const Metric middle = Metric::isotropic(std::sqrt(least * most));
            storage_.metrics().set(l.leaf, middle);
            Departure& departure = departures_[l.leaf];
            departure.take(nonconformity(middle, Metric::isotropic(most)), l.box.centre());
            if (Node::arity == 2 && departure.worst > field_.target()) {
                departure.along = judge.along(l, nearby);
            }
        });
    }

    // Raises the departures of leaves that are not settled by the sources in them.
    void sample_sources() {
        std::vector<double> of_source(sources_.size(), 0);
        in_parallel(sources_.size(), [&](std::size_t i) {
            // A leaf that is cut stays as one of its parts, which is fresh.
            LeafIndex& leaf = leaf_of_source_[i];
            if (states_[leaf] == LeafState::settled) return;
            leaf = tree_.find(sources_[i]);
            of_source[i] = directional_nonconformity(
                value_in(tree_, field_of(storage_), leaf, sources_[i]), at_sources_[i]);
        });
        for (std::size_t i = 0; i < sources_.size(); ++i) {
            departures_[leaf_of_source_[i]].take(of_source[i], sources_[i]);
        }
    }

    const Topology<Node>& tree_;
    Storage& storage_;
    const GoalField& field_;
    double aim_;  // leaves above it are cut
    bool is_thorough_ = false;
    const std::size_t max_leaves_;
    const GrowthLimit limit_;
    bool is_late_ = false;
    std::vector<Point> sources_;
    std::vector<Metric> at_sources_;  // the field there
    NextToSources<Node, Storage> next_to_sources_;
    std::vector<LeafIndex> leaf_of_source_;
    std::vector<LeafState> states_;                    // of the leaves
    std::vector<Departure> departures_;                // likewise
    std::vector<std::vector<std::uint32_t>> lessons_;  // likewise, where the storage learns
    std::uint64_t places_used_ = 0;
};

}  // namespace controlspace
