#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "metric/nonconformity.h"
#include "spaces/goal_field.h"
#include "spaces/nearby_field.h"
#include "spaces/topology.h"

namespace controlspace {

/// Calls visit(i) for i from 0 to n - 1, on all of TBB's threads; each works with copies of
/// `visit`.
template <class Visit>
void in_parallel(std::size_t n, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 16), [&](const auto& part) {
        Visit own = visit;
        for (std::size_t i = part.begin(); i < part.end(); ++i) own(i);
    });
}

/// Where a leaf is compared with the field, each coordinate in units of its edges: corners, centre,
/// centres of faces (low z, y, x, high x, y, z), middles of edges.
struct LeafPlaces {
    static constexpr std::size_t corners = 0, centre = corners + 8, faces = centre + 1,
                                 edges = faces + 6, all = edges + 12;
    std::array<Vector, all> at;

    LeafPlaces();
    static constexpr std::size_t low_face(std::size_t axis) { return faces + 2 - axis; }
    static constexpr std::size_t high_face(std::size_t axis) { return faces + 3 + axis; }
    Point in(const Box& box, std::size_t i) const {
        return box.low + at[i].cwiseProduct(box.edges());
    }
};
const LeafPlaces& leaf_places();

/// Place `k` of an endless sequence that fills the box evenly (the additive recurrence R_3, on the
/// powers of the root of x^4 = x + 1).
Point place_in(const Box& box, std::uint64_t k);

/// How the departure of a storage shows along which axis a leaf should be cut.
enum class CutBy {
    corners,      ///< constant in a leaf: the departure differs between opposite corners
    faces,        ///< from the centre outwards: it is large at the faces across the axis
    edges,        ///< right at the corners: it is large in the middle of edges along the axis
    longest_edge  ///< it does not show
};

/// How a leaf compares with the field.
struct Departure {
    double worst = 0;             ///< δ, or a bound: lower above the target, upper below 3/4 of it
    Point where = Point::Zero();  ///< the place of it
    std::array<double, 3> along{};  ///< how much speaks for a cut across each axis
    bool is_elsewhere = false;      ///< above the target only at a place that was not fitted to

    void take(double delta, const Point& x) {
        if (!(delta > worst)) return;
        worst = delta;
        where = x;
    }
};

/// A leaf of a tree that is being adapted.
struct AdaptedLeaf {
    LeafIndex leaf = 0;
    Box box;
};

/// Compares the leaves of a tree with the field of a goal.
template <class Node, class Storage>
class LeafJudge {
public:
    LeafJudge(const Topology<Node>& tree, const Storage& storage, double target)
        : tree_(tree), storage_(storage), target_(target) {}

    /// At the places of the leaf; where some of them tell that it has to be cut, and how, the
    /// others are not looked at.
    Departure at_places_of(const AdaptedLeaf& of, NearbyField& nearby) const {
        Departure departure;
        LogRatios log_ratio{};
        for (const Range& range : ranges()) {
            look(of, nearby, range, departure, log_ratio);
            if (departure.worst > target_) break;
        }
        if constexpr (Node::arity == 2) departure.along = sums_along(log_ratio);
        return departure;
    }

    /// How much speaks for a cut across each axis.
    std::array<double, 3> along(const AdaptedLeaf& of, NearbyField& nearby) const {
        Departure departure;
        LogRatios log_ratio{};
        look(of, nearby, ranges().front(), departure, log_ratio);
        return sums_along(log_ratio);
    }

    /// At places number `first` to `end - 1` of the sequence in the box.
    Departure at_sequence(const AdaptedLeaf& of, NearbyField& nearby, std::uint64_t first,
                          std::uint64_t end) const {
        std::array<Point, LeafPlaces::all> x;
        LogRatios log_ratio;
        Departure departure;
        while (first < end) {
            const std::size_t n = std::min<std::uint64_t>(x.size(), end - first);
            for (std::size_t i = 0; i < n; ++i) x[i] = place_in(of.box, first++);
            look_at(of, nearby, std::span(x).first(n), departure, log_ratio);
        }
        return departure;
    }

private:
    using LogRatios = std::array<double, LeafPlaces::all>;
    struct Range {
        std::size_t from, to;
    };

    // Of LeafPlaces, those first that tell how to cut.
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

    void look(const AdaptedLeaf& of, NearbyField& nearby, const Range& range, Departure& departure,
              LogRatios& log_ratio) const {
        std::array<Point, LeafPlaces::all> x;
        const std::size_t n = range.to - range.from;
        for (std::size_t i = 0; i < n; ++i) x[i] = leaf_places().in(of.box, range.from + i);
        look_at(of, nearby, std::span(x).first(n), departure,
                std::span(log_ratio).subspan(range.from));
    }

    // Writes the logarithms of how much longer the leaf's lengths are.
    void look_at(const AdaptedLeaf& of, NearbyField& nearby, std::span<const Point> x,
                 Departure& departure, std::span<double> log_ratio) const {
        std::array<Metric, LeafPlaces::all> own, field;
        values_in(of.leaf, x, own);
        const double factor = nearby.evaluate_roughly(x, std::span(field).first(x.size()));
        for (std::size_t i = 0; i < x.size(); ++i) {
            compare(own[i], field[i], factor, x[i], nearby, departure);
            log_ratio[i] = std::log(mean_length(own[i]) / mean_length(field[i]));
        }
    }

    void values_in(LeafIndex leaf, std::span<const Point> x, std::span<Metric> out) const {
        if constexpr (requires { storage_.values_in(tree_, std::span(&leaf, 1), x, out); }) {
            std::array<LeafIndex, LeafPlaces::all> leaves;
            leaves.fill(leaf);
            storage_.values_in(tree_, std::span(leaves).first(x.size()), x, out);
        } else {
            for (std::size_t i = 0; i < x.size(); ++i) {
                out[i] = storage_.value_in(tree_, leaf, x[i]);
            }
        }
    }

    // `longest` is the field at x, or longer by less than the factor. What may be near to the
    // target is looked at closely.
    void compare(const Metric& own, const Metric& longest, double factor, const Point& x,
                 NearbyField& nearby, Departure& departure) const {
        const double from_longest = nonconformity(own, longest);
        if (factor == 1) return departure.take(from_longest, x);
        const Metric shortest = (1 / factor) * longest;
        const double from_shortest = nonconformity(own, shortest);
        const double most = std::max(from_longest, from_shortest);
        if (most <= 0.75 * target_) return departure.take(most, x);
        const double least = std::min(from_longest, from_shortest);
        const bool is_outside = own.xx > longest.xx || own.xx < shortest.xx;
        if (is_outside && least > target_) return departure.take(least, x);
        Metric exact;
        nearby.evaluate({&x, 1}, {&exact, 1});
        departure.take(nonconformity(own, exact), x);
    }

    static std::array<double, 3> sums_along(const LogRatios& departure) {
        std::array<double, 3> along{};
        for (std::size_t a = 0; a < 3; ++a) {
            if constexpr (Storage::cut_by == CutBy::corners) {
                for (std::size_t c = 0; c < 8; ++c) {
                    if ((c >> a & 1) != 0) continue;
                    along[a] += std::abs(departure[c | std::size_t{1} << a] - departure[c]);
                }
            } else if constexpr (Storage::cut_by == CutBy::faces) {
                along[a] = std::abs(departure[LeafPlaces::low_face(a)]) +
                           std::abs(departure[LeafPlaces::high_face(a)]);
            } else if constexpr (Storage::cut_by == CutBy::edges) {
                for (std::size_t i = LeafPlaces::edges; i < LeafPlaces::all; ++i) {
                    if (leaf_places().at[i][static_cast<Axis>(a)] == 0.5) {
                        along[a] += std::abs(departure[i]);
                    }
                }
            }
        }
        return along;
    }

    const Topology<Node>& tree_;
    const Storage& storage_;
    double target_;
};

/// Splits leaves of a tree, which should consist of its root, until each is within the target of
/// the field wherever it is looked at.
template <class Node, class Storage>
class TreeAdaptation {
public:
    TreeAdaptation(const Topology<Node>& tree, Storage& storage, const GoalField& field,
                   const AdaptationGoal& goal)
        : tree_(tree), storage_(storage), field_(field) {
        for (const PointSource& source : goal.sources) sources_.push_back(source.position);
        at_sources_.resize(sources_.size());
        leaf_of_source_.resize(sources_.size(), 0);
        field.evaluate(sources_, at_sources_);
    }

    /// `split(box, along, cut)` cuts the leaf with that box, across an axis for which `along`
    /// speaks most, and appends to `cut` the numbers of all leaves that it had to cut; it returns
    /// false where the leaf must stay as it is.
    ///
    /// Leaves are looked at in their LeafPlaces; if `proved`, those that pass also at other places.
    /// What is found wanting is put right and looked at again, at places of its own. Returns the
    /// largest departure that is left.
    template <class Split>
    double run(bool proved, Split&& split) {
        states_.assign(tree_.leaves(), LeafState::fresh);
        departures_.resize(tree_.leaves());
        while (round(proved, split)) {
        }
        if constexpr (Storage::follows_neighbours) {
            // Neighbours may have been cut after a leaf was looked at.
            constexpr int looks_at_all = 2;
            for (int look = 0; proved && look < looks_at_all; ++look) {
                states_.assign(tree_.leaves(), LeafState::changed);
                while (round(proved, split)) {
                }
            }
        }
        double left = 0;
        for (const Departure& d : departures_) left = std::max(left, d.worst);
        return left;
    }

private:
    enum class LeafState : std::uint8_t { settled, changed, fresh };

    // Looks at the leaves that are not settled, and settles them or puts them right. Returns
    // whether some have to be looked at again.
    template <class Split>
    bool round(bool proved, Split&& split) {
        const std::vector<AdaptedLeaf> young = leaves_to_look_at(LeafState::changed);
        storage_.fit(tree_, leaves_to_look_at(LeafState::fresh), field_, proved);
        look(young, proved);
        for (const AdaptedLeaf& l : young) states_[l.leaf] = LeafState::settled;
        bool changes = false;
        std::vector<LeafIndex> cut;
        for (const AdaptedLeaf& l : young) {
            // It may have been cut to make way for a neighbour.
            if (states_[l.leaf] != LeafState::settled) continue;
            Departure& departure = departures_[l.leaf];
            if (!(departure.worst > field_.target())) continue;
            if (departure.is_elsewhere && storage_.learn(l.leaf, departure.where, field_)) {
                states_[l.leaf] = LeafState::changed;
                changes = true;
                continue;
            }
            cut.clear();
            changes = split(l.box, departure.along, cut) || changes;
            departures_.resize(tree_.leaves());
            states_.resize(tree_.leaves(), LeafState::fresh);
            for (const LeafIndex leaf : cut) states_[leaf] = LeafState::fresh;
        }
        return changes;
    }

    // Those in this state, or in a later one.
    std::vector<AdaptedLeaf> leaves_to_look_at(LeafState least) const {
        std::vector<AdaptedLeaf> leaves;
        tree_.for_each_leaf([&](LeafIndex leaf, const Box& box) {
            if (states_[leaf] >= least) leaves.push_back({leaf, box});
        });
        return leaves;
    }

    // At their own places, if fresh, and, if `proved`, at places that no leaf has been fitted to:
    // some in each leaf, more in a large one, and the more the closer the target.
    void look(std::span<const AdaptedLeaf> leaves, bool proved) {
        const double places_in_domain = 5e3 / field_.target();
        constexpr std::uint64_t places_at_least = 16;
        const double volume = tree_.domain().edges().prod();
        std::vector<std::uint64_t> first(leaves.size() + 1, places_used_);
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const double share = leaves[i].box.edges().prod() / volume;
            first[i + 1] =
                first[i] + places_at_least + static_cast<std::uint64_t>(share * places_in_domain);
        }
        places_used_ = first.back();
        for (const AdaptedLeaf& l : leaves) departures_[l.leaf] = {};
        const LeafJudge judge(tree_, storage_, field_.target());
        if constexpr (Storage::cut_by == CutBy::corners) {
            if (field_.has_ranges()) {
                fit_to_ranges(leaves, judge);
                return;
            }
        }
        look_at_sources();
        in_parallel(leaves.size(), [&, nearby = NearbyField(field_)](std::size_t i) mutable {
            const AdaptedLeaf& l = leaves[i];
            nearby.enter(l.box);
            Departure& departure = departures_[l.leaf];
            const auto is_bad = [&] { return departure.worst > field_.target(); };
            const bool needs_axis = Node::arity == 2;
            if (states_[l.leaf] == LeafState::fresh && !storage_.is_fitted(l.leaf) &&
                (needs_axis || !is_bad())) {
                const Departure own = judge.at_places_of(l, nearby);
                departure.take(own.worst, own.where);
                departure.along = own.along;
            }
            if (!proved || is_bad()) return;
            const Departure elsewhere = judge.at_sequence(l, nearby, first[i], first[i + 1]);
            departure.take(elsewhere.worst, elsewhere.where);
            departure.is_elsewhere = is_bad();
        });
    }

    // Sets leaves of a constant value to what is between the bounds of the field in them. Bounds
    // hold everywhere in the leaf: no place needs to be looked at.
    void fit_to_ranges(std::span<const AdaptedLeaf> leaves, const LeafJudge<Node, Storage>& judge) {
        in_parallel(leaves.size(), [&, nearby = NearbyField(field_)](std::size_t i) mutable {
            const AdaptedLeaf& l = leaves[i];
            nearby.enter(l.box);
            const auto [least, most] = nearby.range();
            const Metric middle = Metric::isotropic(std::sqrt(least * most));
            storage_.set(l.leaf, middle);
            Departure& departure = departures_[l.leaf];
            departure.take(nonconformity(middle, Metric::isotropic(most)), l.box.centre());
            if (Node::arity == 2 && departure.worst > field_.target()) {
                departure.along = judge.along(l, nearby);
            }
        });
    }

    // Raises the departures of leaves that are not settled by the sources in them.
    void look_at_sources() {
        std::vector<double> of_source(sources_.size(), 0);
        in_parallel(sources_.size(), [&](std::size_t i) {
            // A leaf that is cut stays as one of its parts, which is fresh.
            LeafIndex& leaf = leaf_of_source_[i];
            if (states_[leaf] == LeafState::settled) return;
            leaf = tree_.find(sources_[i]);
            of_source[i] = nonconformity(storage_.value(tree_, sources_[i]), at_sources_[i]);
        });
        for (std::size_t i = 0; i < sources_.size(); ++i) {
            departures_[leaf_of_source_[i]].take(of_source[i], sources_[i]);
        }
    }

    const Topology<Node>& tree_;
    Storage& storage_;
    const GoalField& field_;
    std::vector<Point> sources_;
    std::vector<Metric> at_sources_;
    std::vector<LeafIndex> leaf_of_source_;
    std::vector<LeafState> states_;      // of the leaves
    std::vector<Departure> departures_;  // likewise
    std::uint64_t places_used_ = 0;
};

}  // namespace controlspace
