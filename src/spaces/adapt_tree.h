#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "metric/nonconformity.h"
#include "spaces/goal_field.h"
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
    static constexpr std::size_t corners = 8, centre = corners, faces = centre + 1,
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
    double worst = 0;               ///< δ; a lower bound of it where it is above the target
    Point where = Point::Zero();    ///< the place of it
    std::array<double, 3> along{};  ///< how much speaks for a cut across each axis

    void take(double delta, const Point& x) {
        if (!(delta > worst)) return;
        worst = delta;
        where = x;
    }
};

/// Compares the leaves of a tree with the field of a goal.
template <class Node, class Storage>
class LeafJudge {
public:
    LeafJudge(const Topology<Node>& tree, const Storage& storage, const GoalField& field)
        : tree_(tree), storage_(storage), field_(field) {}

    /// At the places of the leaf.
    Departure at_places_of(const Box& box) const {
        std::array<Metric, LeafPlaces::all> field;
        std::array<double, LeafPlaces::all> log_ratio{};
        Departure departure;
        const auto look = [&](std::size_t from, std::size_t to) {
            std::array<Point, LeafPlaces::all> x;
            for (std::size_t i = from; i < to; ++i) x[i] = leaf_places().in(box, i);
            field_.evaluate_here(std::span(x).subspan(from, to - from),
                                 std::span(field).subspan(from, to - from));
            for (std::size_t i = from; i < to; ++i) {
                const Metric own = storage_.value(tree_, x[i]);
                departure.take(nonconformity(own, field[i]), x[i]);
                log_ratio[i] = std::log(mean_length(own) / mean_length(field[i]));
            }
        };
        // Most leaves that have to be cut show it at their corners.
        constexpr bool corners_tell =
            Storage::cut_by == CutBy::corners || Storage::cut_by == CutBy::longest_edge;
        look(0, LeafPlaces::faces);
        if (!corners_tell || departure.worst <= field_.target()) {
            look(LeafPlaces::faces,
                 Storage::cut_by == CutBy::corners ? LeafPlaces::edges : LeafPlaces::all);
        }
        if constexpr (Node::arity == 2) departure.along = sums_along(log_ratio);
        return departure;
    }

    /// At places number `first` to `end - 1` of the sequence in the box.
    Departure at_sequence(const Box& box, std::uint64_t first, std::uint64_t end) const {
        std::array<Point, 16> x;
        std::array<Metric, 16> field;
        Departure departure;
        while (first < end) {
            const std::size_t n = std::min<std::uint64_t>(x.size(), end - first);
            for (std::size_t i = 0; i < n; ++i) x[i] = place_in(box, first++);
            field_.evaluate_here(std::span(x).first(n), std::span(field).first(n));
            for (std::size_t i = 0; i < n; ++i) {
                departure.take(nonconformity(storage_.value(tree_, x[i]), field[i]), x[i]);
            }
        }
        return departure;
    }

private:
    static std::array<double, 3> sums_along(const std::array<double, LeafPlaces::all>& departure) {
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
    const GoalField& field_;
};

/// A leaf of a tree that is being adapted.
struct AdaptedLeaf {
    LeafIndex leaf = 0;
    Box box;
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
        field.evaluate(sources_, at_sources_);
    }

    /// `split(box, along, cut)` cuts the leaf with that box, across an axis for which `along`
    /// speaks most, and appends to `cut` the numbers of all leaves that it had to cut; it returns
    /// false where the leaf must stay as it is.
    ///
    /// After each leaf has been looked at in its LeafPlaces, a proof looks at other places; what is
    /// found wanting there is put right and looked at again. Each of `proofs` looks at all leaves,
    /// at places of its own. Returns the largest departure that is left.
    template <class Split>
    double run(int proofs, Split&& split) {
        // Leaves that were not looked at since they changed: at their own places, and elsewhere.
        std::vector<std::uint8_t> fresh(tree_.leaves(), 1), unproved(tree_.leaves(), 1);
        std::vector<std::uint8_t> stays(tree_.leaves(), 0);
        std::vector<Departure> departures(tree_.leaves());
        const bool is_proved = proofs > 0;
        std::uint64_t places_used = 0;
        for (;;) {
            const std::vector<AdaptedLeaf> leaves = all_leaves();
            fit_and_look(chosen(leaves, fresh), fresh, is_proved, departures);
            fresh.assign(fresh.size(), 0);
            const auto is_bad = [&](const AdaptedLeaf& l) {
                return departures[l.leaf].worst > field_.target() && stays[l.leaf] == 0;
            };
            const bool all_fit = std::ranges::none_of(leaves, is_bad);
            if (all_fit) {
                const std::vector<AdaptedLeaf> changed = chosen(leaves, unproved);
                if (proofs > 0) places_used = look_elsewhere(changed, places_used, departures);
                unproved.assign(unproved.size(), 0);
                if (proofs > 1 && std::ranges::none_of(changed, is_bad)) {
                    places_used = look_elsewhere(leaves, places_used, departures);
                    look_at_sources(std::vector<std::uint8_t>(tree_.leaves(), 1), departures);
                    --proofs;
                }
            }

            bool changes = false;
            std::vector<LeafIndex> cut;
            for (const AdaptedLeaf& l : leaves) {
                if (!is_bad(l) || fresh[l.leaf] != 0) continue;
                Departure& departure = departures[l.leaf];
                changes = true;
                if (all_fit && storage_.learn(l.leaf, departure.where, field_)) {
                    departure = {};
                    unproved[l.leaf] = 1;
                    continue;
                }
                cut.clear();
                if (!split(l.box, departure.along, cut)) stays[l.leaf] = 1;
                departures.resize(tree_.leaves());
                fresh.resize(tree_.leaves(), 1);
                unproved.resize(tree_.leaves(), 1);
                stays.resize(tree_.leaves(), 0);
                for (const LeafIndex leaf : cut) {
                    fresh[leaf] = unproved[leaf] = 1;
                    departures[leaf] = {};
                }
            }
            if (all_fit && !changes) break;
        }
        double left = 0;
        for (const Departure& d : departures) left = std::max(left, d.worst);
        return left;
    }

private:
    static std::vector<AdaptedLeaf> chosen(std::span<const AdaptedLeaf> leaves,
                                           std::span<const std::uint8_t> flags) {
        std::vector<AdaptedLeaf> those;
        std::ranges::copy_if(leaves, std::back_inserter(those),
                             [&](const AdaptedLeaf& l) { return flags[l.leaf] != 0; });
        return those;
    }

    std::vector<AdaptedLeaf> all_leaves() const {
        std::vector<AdaptedLeaf> leaves;
        leaves.reserve(tree_.leaves());
        tree_.for_each_leaf([&](LeafIndex leaf, const Box& box) { leaves.push_back({leaf, box}); });
        return leaves;
    }

    // For the `young` leaves, which are those marked `fresh`. Departures are by the leaves'
    // numbers.
    void fit_and_look(std::span<const AdaptedLeaf> young, std::span<const std::uint8_t> fresh,
                      bool proved, std::span<Departure> departures) {
        storage_.fit(tree_, young, field_, proved);
        const LeafJudge judge(tree_, storage_, field_);
        in_parallel(young.size(), [&](std::size_t i) {
            if (storage_.is_fitted(young[i].leaf)) return;
            departures[young[i].leaf] = judge.at_places_of(young[i].box);
        });
        look_at_sources(fresh, departures);
    }

    // Raises the departures of leaves marked in `flags` by the sources in them.
    void look_at_sources(std::span<const std::uint8_t> flags,
                         std::span<Departure> departures) const {
        std::vector<double> of_source(sources_.size(), 0);
        std::vector<LeafIndex> leaf_of(sources_.size());
        in_parallel(sources_.size(), [&](std::size_t i) {
            leaf_of[i] = tree_.find(sources_[i]);
            if (flags[leaf_of[i]] == 0) return;
            of_source[i] = nonconformity(storage_.value(tree_, sources_[i]), at_sources_[i]);
        });
        for (std::size_t i = 0; i < sources_.size(); ++i) {
            departures[leaf_of[i]].take(of_source[i], sources_[i]);
        }
    }

    // Raises departures by places that no leaf has been fitted to: some in each leaf, more in a
    // large one. Returns how many.
    std::uint64_t look_elsewhere(std::span<const AdaptedLeaf> leaves, std::uint64_t first_place,
                                 std::span<Departure> departures) const {
        constexpr double places_in_domain = 2e5;
        constexpr std::uint64_t places_at_least = 8;
        const double volume = tree_.domain().edges().prod();
        std::vector<std::uint64_t> first(leaves.size() + 1, first_place);
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const double share = leaves[i].box.edges().prod() / volume;
            first[i + 1] =
                first[i] + places_at_least + static_cast<std::uint64_t>(share * places_in_domain);
        }
        const LeafJudge judge(tree_, storage_, field_);
        in_parallel(leaves.size(), [&](std::size_t i) {
            const Departure elsewhere = judge.at_sequence(leaves[i].box, first[i], first[i + 1]);
            departures[leaves[i].leaf].take(elsewhere.worst, elsewhere.where);
        });
        return first.back();
    }

    const Topology<Node>& tree_;
    Storage& storage_;
    const GoalField& field_;
    std::vector<Point> sources_;
    std::vector<Metric> at_sources_;
};

}  // namespace controlspace
