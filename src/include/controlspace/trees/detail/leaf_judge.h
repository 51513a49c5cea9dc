// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "controlspace/geometry/detail/place_sequence.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/trees/detail/departure.h"
#include "controlspace/trees/detail/leaf_places.h"
#include "controlspace/trees/detail/nearby_field.h"
#include "controlspace/trees/detail/peaks.h"
#include "controlspace/trees/detail/sample_leaves.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// What is found in a leaf.
struct Findings {
    Departure departure;
    Peaks peaks;

    explicit Findings(const LeafBox& leaf) : departure(), peaks(leaf.box) {}
    void take(double delta, const Point& x) {
        departure.take(delta, x);
        peaks.enter(delta, x);
    }
};

/// Compares the leaves of a tree with the field of a goal.
template <class Node, class Storage>
class LeafJudge {
public:
    LeafJudge(const Topology<Node>& tree, const Storage& storage, double target)
        : tree_(tree), storage_(storage), target_(target) {}

    /// At the places of the leaf; the others are skipped where some of them show that it has to be
    /// cut, and how.
    void at_places_of(const LeafBox& of, NearbyField& nearby, Findings& found) const {
        Compared compared;
        for (std::size_t r = 0; r < ranges().size(); ++r) {
            compare_at(of, nearby, ranges()[r], r < shared_ranges ? Cones::shared : Cones::all,
                       found, compared);
            if (found.departure.worst > target_) break;
        }
        if constexpr (Node::arity == 2) found.departure.along = sums_along(compared);
    }

    /// How much speaks for a cut across each axis.
    std::array<double, 3> along(const LeafBox& of, NearbyField& nearby) const {
        Findings found(of);
        Compared compared;
        compare_at(of, nearby, ranges().front(), Cones::shared, found, compared);
        return sums_along(compared);
    }

    /// At places number `first` to `end - 1` of the sequence in a box that is larger than the leaf:
    /// those beyond it stand for its faces, edges and corners.
    void at_sequence(const LeafBox& of, NearbyField& nearby, std::uint64_t first, std::uint64_t end,
                     Findings& found) const {
        std::array<Point, LeafPlaces::all> x;
        const Vector beyond = 0.125 * of.box.edges();
        const Box box{of.box.low - beyond, of.box.high + beyond};
        while (first < end) {
            const std::size_t n = std::min<std::uint64_t>(x.size(), end - first);
            for (std::size_t i = 0; i < n; ++i) x[i] = nearest_in(of.box, place_in(box, first++));
            compare_with(of, nearby, std::span(x).first(n), Cones::close, found);
        }
    }

    /// On its faces, between the places of the leaf; on its edges too, where `along_edges` is not
    /// for it.
    void at_places_between(const LeafBox& of, NearbyField& nearby, Findings& found) const {
        std::array<Point, LeafPlaces::between_on_edges> x;
        std::size_t first = HasTrilinearLeaves<Storage> ? LeafPlaces::between_on_edges : 0;
        for (; first < LeafPlaces::between; first += x.size()) {
            for (std::size_t i = 0; i < x.size(); ++i) {
                x[i] =
                    of.box.low + leaf_places().at_between[first + i].cwiseProduct(of.box.edges());
            }
            compare_with(of, nearby, x, Cones::close, found);
        }
    }

    /// Along its edges, where the field is that of the leaf at the corners: in the middle of parts
    /// of them, as long as some part is so long, in the metrics at its ends, that the target may be
    /// exceeded in it. The logarithm of a length changes by the slope of cones, at most, per unit.
    void along_edges(const LeafBox& of, NearbyField& nearby, double slope, Findings& found) const {
        struct Part {
            double from, to;
            std::array<double, 2> logarithm, size;  // at the ends: of a factor; of the whole edge
            double most(double slope) const {
                const double units = (to - from) * std::max(size[0], size[1]);
                return 0.5 * (logarithm[0] + logarithm[1] + slope * units);
            }
        };
        constexpr std::size_t most_parts = 16;
        const double allowed = logarithm_of(target_);
        for (int edge = 0; edge < 12; ++edge) {
            const Axis axis = edge % 3;
            const int side = edge / 3;
            Point low = of.box.low;
            low[(axis + 1) % 3] = ((side & 1) != 0 ? of.box.high : of.box.low)[(axis + 1) % 3];
            low[(axis + 2) % 3] = ((side & 2) != 0 ? of.box.high : of.box.low)[(axis + 2) % 3];
            Point high = low;
            high[axis] = of.box.high[axis];
            std::array<Metric, 2> ends;
            values_in(of.leaf, std::array{low, high}, ends);
            const Vector along = high - low;
            std::array<Part, most_parts> parts;
            parts[0] = {
                0, 1, {0, 0}, {metric_length(ends[0], along), metric_length(ends[1], along)}};
            for (std::size_t count = 1; count < most_parts; ++count) {
                Part& part =
                    *std::ranges::max_element(parts.begin(), parts.begin() + count, {},
                                              [&](const Part& p) { return p.most(slope); });
                if (part.most(slope) <= allowed) break;
                const double middle = 0.5 * (part.from + part.to);
                const Point x = low + middle * along;
                Metric own, field;
                values_in(of.leaf, {&x, 1}, {&own, 1});
                const double factor = nearby.evaluate_roughly({&x, 1}, Cones::close, {&field, 1});
                compare(own, field, factor, x, nearby, found);
                if (found.departure.worst > target_) return;
                const double logarithm = logarithm_of(directional_nonconformity(own, field));
                const double size = metric_length(field, along);
                parts[count] = part;
                parts[count].from = part.to = middle;
                parts[count].logarithm[0] = part.logarithm[1] = logarithm;
                parts[count].size[0] = part.size[1] = size;
            }
        }
    }

    /// Of lengths that are trilinear in the leaf: the target, if bounds show that it is kept
    /// everywhere; otherwise more, without bound where they show nothing.
    Departure everywhere(const LeafBox& of, NearbyField& nearby) const {
        std::array<double, 8> at_corners;
        const auto metrics = storage_.metrics().field();
        std::ranges::transform(storage_.nodes_of(of.leaf), at_corners.begin(),
                               [&](const auto node) { return metrics[node].xx; });
        Departure departure;
        const auto doubt = nearby.doubt_of(at_corners);
        if (!doubt) {
            departure.take(target_, of.box.centre());
            return departure;
        }
        if (doubt->is_certain) {
            Metric own;
            values_in(of.leaf, {&doubt->where, 1}, {&own, 1});
            departure.take(nonconformity(own, nearby.at(doubt->where)), doubt->where);
        }
        if (!(departure.worst > target_)) {
            departure.take(std::numeric_limits<double>::infinity(), doubt->where);
        }
        return departure;
    }

    /// At a place where the departure is estimated, and at others until one is above the target;
    /// far above it the estimate will do.
    void examine(const LeafBox& of, NearbyField& nearby, const Departure& estimate,
                 std::span<const Point> others, Findings& found) const {
        constexpr double far_above = 1.2;
        if (estimate.worst > far_above * target_) return found.take(estimate.worst, estimate.where);
        if (estimate.worst > 0) {
            compare_with(of, nearby, {&estimate.where, 1}, Cones::close, found);
        }
        while (!others.empty() && !(found.departure.worst > target_)) {
            const std::size_t n = std::min<std::size_t>(others.size(), LeafPlaces::all);
            compare_with(of, nearby, others.first(n), Cones::close, found);
            others = others.subspan(n);
        }
    }

    /// Hill climbs from the worst peak found so far, `thorough` from all, as long as they come near
    /// enough to the target: the nearer, the longer they have taken, in the first rounds most of
    /// all, for most climbs from far below lead nowhere. At places all around: what is climbed has
    /// creases, where other cones begin to matter. They end where the target is farther away than
    /// the places, and beside the summit of a climb before that is as high.
    void climb(const LeafBox& of, NearbyField& nearby, double slope, bool thorough,
               Findings& found) const {
        constexpr int rounds = 16;
        constexpr int further_rounds = 32;
        constexpr int tries = 6;
        std::array<Point, tries> x;
        std::uint64_t next = 0;
        Peaks starts = found.peaks;
        const std::span<const Peaks::Peak> sorted = starts.sorted();
        const std::size_t most = thorough ? Peaks::most : 1;
        Peaks summits(of.box);
        for (const Peaks::Peak& start : sorted.first(std::min(most, sorted.size()))) {
            Findings climbed(of);
            climbed.departure.take(start.delta, start.where);
            Departure& best = climbed.departure;
            Vector reach = 0.25 * of.box.edges();
            for (int round = 0; round < (thorough ? rounds + further_rounds : rounds); ++round) {
                if (found.departure.worst > target_) return;
                const double near =
                    std::max(std::min(0.5 + 0.05 * round, 0.65),
                             std::min(0.5 * (1 + static_cast<double>(round) / rounds), 0.9));
                if (!(best.worst > near * target_)) break;
                if (summits.has_beside(best.worst, best.where)) break;
                if (round == rounds) reach = 0.1 * of.box.edges();
                // The logarithm of a length changes by the slope of cones, at most, per unit; that
                // of the leaf's own by about as much.
                Metric own;
                values_in(of.leaf, {&best.where, 1}, {&own, 1});
                const auto units = metric_edge_lengths(own, reach);
                const double attainable =
                    logarithm_of(best.worst) + 2 * slope * (units[0] + units[1] + units[2]);
                if (!(attainable > logarithm_of(target_))) {
                    if (round >= rounds) break;
                    round = rounds - 1;
                    continue;
                }
                // Some much nearer: peaks at sources are far narrower than their leaf. From a face,
                // which creases cross, most stay on it; from an edge, on it or on one of its faces.
                const auto is_on_face = [&, at = best.where](Axis a) {
                    return at[a] == of.box.low[a] || at[a] == of.box.high[a];
                };
                const int faces = is_on_face(0) + is_on_face(1) + is_on_face(2);
                for (int i = 0; i < tries; ++i) {
                    const Vector side = i % 2 == 0 ? reach : 0.15 * reach;
                    const Box around{best.where - side, best.where + side};
                    Point& y = x[static_cast<std::size_t>(i)];
                    y = nearest_in(of.box, place_in(around, next++));
                    int faces_to_left = faces == 2 && i > 2 ? (i + round) % 2 : -1;
                    for (Axis a = 0; a < 3 && i > 1 && faces < 3; ++a) {
                        if (is_on_face(a) && faces_to_left-- != 0) y[a] = best.where[a];
                    }
                }
                const double before = best.worst;
                compare_with(of, nearby, x, Cones::close, climbed);
                if (!(best.worst > before)) reach *= round < rounds ? 0.6 : 0.8;
                found.departure.take(best.worst, best.where);
            }
            summits.enter(best.worst, best.where);
        }
    }

    struct Range {
        std::size_t from, to;
    };
    /// Of LeafPlaces, those first that show how to cut.
    static constexpr auto ranges() {
        using P = LeafPlaces;
        if constexpr (Storage::cut_by == CutBy::corners) {
            return std::array{Range{P::corners, P::faces}, Range{P::faces, P::edges}};
        } else if constexpr (Storage::cut_by == CutBy::edges) {
            return std::array{Range{P::edges, P::all}, Range{P::centre, P::edges}};
        } else if constexpr (Storage::cut_by == CutBy::faces) {
            return std::array{Range{P::centre, P::edges}, Range{P::corners, P::centre},
                              Range{P::edges, P::all}};
        } else {
            return std::array{Range{P::corners, P::faces}, Range{P::faces, P::all}};
        }
    }

    /// Of the ranges, those at which leaves side by side and parts of leaves ask for the same
    /// places
    /// (`evaluate_shared`): in octrees all; in kd-trees parts have none of the others.
    static constexpr std::size_t shared_ranges = Node::arity == 2 ? 1 : ranges().size();

private:
    using Cones = NearbyField::Cones;
    // Metrics of the leaf and of the field.
    struct Compared {
        std::array<Metric, LeafPlaces::all> own, field;
    };

    void compare_at(const LeafBox& of, NearbyField& nearby, const Range& range, Cones cones,
                    Findings& found, Compared& compared) const {
        std::array<Point, LeafPlaces::all> x;
        const std::size_t n = range.to - range.from;
        for (std::size_t i = 0; i < n; ++i) x[i] = leaf_places().in(of.box, range.from + i);
        compare_with(of, nearby, std::span(x).first(n), cones, found,
                     std::span(compared.own).subspan(range.from, n),
                     std::span(compared.field).subspan(range.from, n));
    }

    void compare_with(const LeafBox& of, NearbyField& nearby, std::span<const Point> x, Cones cones,
                      Findings& found) const {
        Compared compared;
        compare_with(of, nearby, x, cones, found, std::span(compared.own).first(x.size()),
                     std::span(compared.field).first(x.size()));
    }

    void compare_with(const LeafBox& of, NearbyField& nearby, std::span<const Point> x, Cones cones,
                      Findings& found, std::span<Metric> own, std::span<Metric> field) const {
        values_in(of.leaf, x, own);
        const double factor = nearby.evaluate_roughly(x, cones, field);
        for (std::size_t i = 0; i < x.size(); ++i) {
            compare(own[i], field[i], factor, x[i], nearby, found);
        }
    }

    void values_in(LeafIndex leaf, std::span<const Point> x, std::span<Metric> out) const {
        std::array<LeafIndex, LeafPlaces::all> leaves;
        leaves.fill(leaf);
        field_of(storage_).values_in(tree_, std::span(leaves).first(x.size()), x, out);
    }

    // `longest` is the field at x, or longer by less than the factor. What may be near to the
    // target, and is the worst so far, is evaluated exactly.
    void compare(const Metric& own, const Metric& longest, double factor, const Point& x,
                 NearbyField& nearby, Findings& found) const {
        if (factor == 1) return found.take(directional_nonconformity(own, longest), x);
        if (std::isinf(factor)) {
            Metric exact = longest;
            double delta = directional_nonconformity(own, exact);
            const double most = delta + 0.1 * target_;
            if (most > std::max(target_, found.departure.worst) && !(delta > 1.5 * target_)) {
                nearby.evaluate({&x, 1}, {&exact, 1});
                delta = directional_nonconformity(own, exact);
            }
            return found.take(delta, x);
        }
        const double from_longest = nonconformity(own, longest);
        const Metric shortest = (1 / factor) * longest;
        const double from_shortest = nonconformity(own, shortest);
        const double most = std::max(from_longest, from_shortest);
        if (most <= 0.75 * target_) return found.take(most, x);
        const double least = std::min(from_longest, from_shortest);
        const bool is_outside = own.xx > longest.xx || own.xx < shortest.xx;
        if (is_outside && least > target_) return found.take(least, x);
        Metric exact;
        nearby.evaluate({&x, 1}, {&exact, 1});
        found.take(nonconformity(own, exact), x);
    }

    // Of the largest factor of lengths in one direction.
    static double logarithm_of(double delta) { return std::log(largest_factor_along(delta)); }

    // Axes across which the field changes, or departs from the leaf's own, most.
    static std::array<double, 3> sums_along(const Compared& compared) {
        const auto& [own, field] = compared;
        const auto change = [](const Metric& from, const Metric& to) {
            return std::log(largest_ratio(from, to));
        };
        const auto departure = [&](std::size_t i) { return change(own[i], field[i]); };
        std::array<double, 3> along{};
        for (std::size_t a = 0; a < 3; ++a) {
            if constexpr (Storage::cut_by == CutBy::corners) {
                for (std::size_t c = 0; c < 8; ++c) {
                    if ((c >> a & 1) != 0) continue;
                    along[a] += change(field[c], field[c | std::size_t{1} << a]);
                }
            } else if constexpr (Storage::cut_by == CutBy::faces) {
                along[a] = departure(LeafPlaces::low_face(a)) + departure(LeafPlaces::high_face(a));
            } else if constexpr (Storage::cut_by == CutBy::edges) {
                for (std::size_t i = LeafPlaces::edges; i < LeafPlaces::all; ++i) {
                    if (leaf_places().at[i][static_cast<Axis>(a)] == 0.5) along[a] += departure(i);
                }
            }
        }
        return along;
    }

    const Topology<Node>& tree_;
    const Storage& storage_;
    double target_;
};

}  // namespace controlspace
