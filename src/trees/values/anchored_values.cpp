// SPDX-License-Identifier: Apache-2.0
#include "trees/values/anchored_values.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <vector>

#include "cones/cone_field.h"
#include "cones/order_free_cones.h"
#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/metric/order_free_intersection.h"
#include "metric/decompose.h"
#include "metric/interior_point.h"
#include "trees/adaptation/nearby_field.h"
#include "trees/in_parallel.h"

namespace controlspace {

namespace {

// Shortening all lengths by a small fraction t gives δ = √3 t^2: a cone may be left out where it
// shortens some by this, and most of the target remains for places in between.
double negligible_shortening(double target) { return 0.5 * std::sqrt(target); }

// Share of the target that is left at places to which leaves are fitted.
constexpr double well_within = 0.25;

}  // namespace

AnchoredValues::AnchoredValues(const SpaceOptions& options)
    : largest_(largest_metric(options)),
      ratio_(options.ratio),
      intersection_(options.intersection) {}

Metric AnchoredValues::cones_at(const Point& x, std::span<const SourceIndex> anchors) const {
    if (sources_.all_isotropic()) {
        double h = largest_.xx;
        const auto shorten = [&](SourceIndex s, double slope) {
            h = std::min(h, sources_.metric(s).xx + slope * (x - sources_.position(s)).norm());
        };
        if (sources_.all_grow_alike()) {
            for (const SourceIndex s : anchors) shorten(s, ratio_ - 1);
        } else {
            for (const SourceIndex s : anchors) shorten(s, sources_.growth(s, ratio_) - 1);
        }
        return Metric::isotropic(h);
    }
    return are_order_free() ? largest_within_cones(x, anchors, nullptr) : cones_in_turn(x, anchors);
}

Metric AnchoredValues::largest_within_cones(const Point& x, std::span<const SourceIndex> anchors,
                                            const Metric* further) const {
    std::array<Metric, InteriorPoint::room> few;
    std::vector<Metric> many;
    if (anchors.size() + 2 > few.size()) many.resize(anchors.size() + 2);
    const std::span<Metric> cones = many.empty() ? std::span<Metric>(few) : many;
    std::size_t n = 0;
    cones[n++] = largest_;
    if (further != nullptr) cones[n++] = *further;
    for (const SourceIndex s : anchors) {
        cones[n++] = sources_.factor(s, ratio_, x) * sources_.metric(s);
    }
    // All of few at once: a search for those that matter would take longer.
    if (many.empty() && n > 2) {
        InteriorPoint solution(cones.first(n));
        solution.solve(gap_);
        if (std::abs(solution.gap()) <= gap_) return left_polar_factor(solution.factor());
    }
    return order_free_intersection(cones.first(n), gap_).metric();
}

// Cones of tensors by their smallest lengths at the place, as in the exact field.
Metric AnchoredValues::cones_in_turn(const Point& x, std::span<const SourceIndex> anchors) const {
    struct Cone {
        double smallest, factor;
        std::size_t place;  // in the list

        bool operator<(const Cone& other) const {
            return smallest != other.smallest ? smallest < other.smallest : place < other.place;
        }
    };
    std::array<Cone, most> few;
    std::vector<Cone> many(anchors.size() > few.size() ? anchors.size() : 0);
    const auto cones = (many.empty() ? std::span<Cone>(few) : many).first(anchors.size());
    for (std::size_t i = 0; i < cones.size(); ++i) {
        const double factor = sources_.factor(anchors[i], ratio_, x);
        cones[i] = {factor * sources_.smallest_length(anchors[i]), factor, i};
    }
    std::sort(cones.begin(), cones.end());
    Metric m = largest_;
    for (const Cone& cone : cones) {
        m = intersection(m, cone.factor * sources_.metric(anchors[cone.place]));
    }
    return m;
}

Metric AnchoredValues::value(const Box& domain, LeafIndex leaf, const Point& place) const {
    const Point x = nearest_in(domain, place);
    const auto anchors = anchors_.of(leaf);
    if (!continuous_) return cones_at(x, anchors);
    const Metric further = sample_at(*continuous_, x);
    if (are_order_free()) {
        return largest_within_cones(x, anchors, &further);
    }
    return intersection(cones_at(x, anchors), further);
}

void AnchoredValues::split(const Subdivision& subdivision, LeafIndex leaf) {
    anchors_.repeat(leaf, static_cast<std::size_t>(subdivision.children() - 1));
}

SourceIndex AnchoredValues::add(LeafIndex leaf, const PointSource& source) {
    const SourceIndex index = sources_.add(source);
    anchors_.add(leaf, index);
    return index;
}

Metric AnchoredValues::value(const Box& domain, LeafIndex leaf, const Point& place,
                             LongLists& lists) const {
    const Point x = nearest_in(domain, place);
    const Metric cones = Metric::isotropic(lists.smallest(leaf, x, largest_.xx));
    return continuous_ ? intersection(cones, sample_at(*continuous_, x)) : cones;
}

void AnchoredValues::take_over(const AdaptationGoal& goal) {
    ratio_ = goal.ratio;
    intersection_ = goal.intersection;
    gap_ = OrderFreeCones::gap_of(std::min(0.1 * goal.target, 0.1));  // as the goal's field
    continuous_ = goal.continuous;
    largest_ = Metric::isotropic(std::min(largest_.xx, goal.h_max));
    sources_ = {};
    for (const PointSource& source : goal.sources) sources_.add(source);
}

bool AnchoredValues::is_covered(SourceIndex source, std::span<const SourceIndex> others,
                                const Box& box, int halvings) const {
    const Metric& own = sources_.metric(source);
    const Point& q = sources_.position(source);
    const auto largest_factor = [&](SourceIndex s) {
        double factor = 1;
        for (int i = 0; i < 8; ++i) {
            factor = std::max(factor, sources_.factor(s, ratio_, corner(box, i)));
        }
        return factor;
    };
    double least = 0;  // of the factor, in the box
    if (is_isotropic(own)) {
        least = sources_.factor(source, ratio_, nearest_in(box, q));
    } else {
        double reach = 0;
        for (int i = 0; i < 8; ++i) {
            reach = std::max(reach, metric_length(own, corner(box, i) - box.centre()));
        }
        const double away = metric_length(own, box.centre() - q) - reach;
        least = 1 + (sources_.growth(source, ratio_) - 1) * std::max(0.0, away);
    }
    const Metric shortest = least * own;
    if (is_within(largest_, 1, shortest)) return true;
    for (const SourceIndex s : others) {
        if (is_within(largest_factor(s) * sources_.metric(s), 1, shortest)) return true;
    }
    if (halvings == 0) return false;
    const Subdivision parts = octants(box);
    for (int c = 0; c < parts.children(); ++c) {
        if (!is_covered(source, others, parts.child(c), halvings - 1)) return false;
    }
    return true;
}

// What the field is at a place, and which sources make it so.
struct AnchoredValues::Known {
    Point x;
    Metric exact;
    std::vector<SourceIndex> governing;
    std::vector<Metric> further;  // or none
};

AnchoredValues::Known AnchoredValues::known_at(const Point& x, NearbyField& nearby,
                                               const GoalField& field) const {
    Known known{x, {}, {}, field.continuous_at({&x, 1})};
    known.exact = nearby.governed(x, negligible_shortening(field.target()), known.governing);
    return known;
}

// What these anchors make of it. In turn, both are of the sources alone.
Metric AnchoredValues::own_at(const Known& known, std::span<const SourceIndex> anchors) const {
    return are_order_free() && !known.further.empty()
               ? largest_within_cones(known.x, anchors, known.further.data())
               : cones_at(known.x, anchors);
}

bool AnchoredValues::add_most_exceeded(const Known& at, const Metric& own,
                                       std::vector<SourceIndex>& list) const {
    if (list.size() >= most_improved()) return false;
    double greatest = 1;
    std::optional<SourceIndex> worst;
    for (const SourceIndex s : at.governing) {
        if (std::ranges::find(list, s) != list.end()) continue;
        const double excess = growth(own, sources_.factor(s, ratio_, at.x) * sources_.metric(s));
        if (!(excess > greatest)) continue;
        greatest = excess;
        worst = s;
    }
    if (worst) list.push_back(*worst);
    return worst.has_value();
}

// The worst place first: what it lacks most is added, until none is far off.
std::vector<SourceIndex> AnchoredValues::fitted(std::span<const Known> places,
                                                double tolerance) const {
    struct State {
        double delta = std::numeric_limits<double>::infinity();
        bool is_new = false;  // of the list as it is
        Metric own;
    };
    std::vector<State> states(places.size());
    std::vector<SourceIndex> list;
    for (;;) {
        const auto worst = std::ranges::max_element(states, {}, &State::delta);
        if (!(worst->delta > tolerance)) return list;
        const Known& place = places[static_cast<std::size_t>(worst - states.begin())];
        if (!worst->is_new) {
            worst->own = own_at(place, list);
            worst->delta = directional_nonconformity(worst->own, place.exact);
            worst->is_new = true;
        } else if (add_most_exceeded(place, worst->own, list)) {
            for (State& state : states) state.is_new = false;
        } else if (list.size() >= most_anchors()) {
            return list;
        } else {
            worst->delta = 0;  // nothing is lacking there
        }
    }
}

void AnchoredValues::fit_closely(std::span<const CellBox> leaves, const GoalField& field) {
    evaluate_shared(field, leaves, LeafPlaces::corners, LeafPlaces::all);
    std::vector<std::vector<SourceIndex>> lists(leaves.size());
    in_parallel(leaves.size(), [&, nearby = NearbyField(field)](std::size_t i) mutable {
        nearby.enter(leaves[i].box, true);
        std::vector<Known> places;
        for (std::size_t k = 0; k < LeafPlaces::all; ++k) {
            places.push_back(known_at(leaf_places().in(leaves[i].box, k), nearby, field));
        }
        lists[i] = fitted(places, well_within * field.target());
    });
    for (std::size_t i = 0; i < leaves.size(); ++i) anchors_.set(leaves[i].cell, lists[i]);
}

void AnchoredValues::fit(std::span<const CellBox> leaves, const GoalField& field,
                         std::size_t places, bool beside_old) {
    const double close = well_within * field.target();
    const double negligible = negligible_shortening(field.target());
    const double factor = largest_factor_within(close);
    std::vector<SourceIndex> chosen(leaves.size() * most);
    std::vector<std::size_t> count(leaves.size(), 0);
    // Cells of an order-free search serve many leaves, and have no effect on answers.
    tbb::enumerable_thread_specific<ConeField::Memory> memories;
    in_parallel(leaves.size(), [&, governing = std::vector<SourceIndex>()](std::size_t i) mutable {
        ConeField::Memory& memory = memories.local();
        const std::span<SourceIndex> list(chosen.data() + i * most, most);
        std::size_t& n = count[i];
        memory.hint = 0;  // of several sources that are equally near the same is found always
        for (std::size_t k = 0; k < places; ++k) {
            const std::size_t p = (LeafPlaces::centre + k) % LeafPlaces::all;  // the centre first
            const Point x = leaf_places().in(leaves[i].box, p);
            const Metric own = cones_at(x, list.first(n));
            if (field.cones().is_isotropic()) {
                const auto below =
                    field.cones().isotropic().source_below(x, own.xx / factor, memory.hint);
                if (below && n < most) list[n++] = *below;
                continue;
            }
            Metric m;
            field.cones().governing(x, negligible, governing, m, memory);
            if (nonconformity(own, m) <= close) continue;
            for (const SourceIndex s : governing) {
                const auto end = list.begin() + static_cast<std::ptrdiff_t>(n);
                if (n < most_anchors() && std::find(list.begin(), end, s) == end) list[n++] = s;
            }
        }
    });
    std::vector<std::vector<SourceIndex>> kept(beside_old ? leaves.size() : 0);
    in_parallel(kept.size(), [&](std::size_t i) {
        const auto fitted = std::span<const SourceIndex>(chosen).subspan(i * most, count[i]);
        constexpr int halvings = 2;
        for (const SourceIndex s : anchors_.of(leaves[i].cell)) {
            if (std::ranges::find(fitted, s) == fitted.end() &&
                !is_covered(s, fitted, leaves[i].box, halvings)) {
                kept[i].push_back(s);
            }
        }
    });
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const auto fitted = std::span<const SourceIndex>(chosen).subspan(i * most, count[i]);
        if (kept.empty() || kept[i].empty()) {
            anchors_.set(leaves[i].cell, fitted);
        } else {
            kept[i].insert(kept[i].end(), fitted.begin(), fitted.end());
            anchors_.set(leaves[i].cell, kept[i]);
        }
    }
}

std::vector<std::uint8_t> AnchoredValues::cover(std::span<const CellBox> leaves,
                                                const GoalField& field) {
    std::vector<std::uint8_t> is_kept(leaves.size(), 0);
    const double tolerance = largest_factor_within(field.target()) - 1;
    std::vector<SourceIndex> chosen(leaves.size() * most);
    std::vector<std::size_t> count(leaves.size());
    in_parallel(leaves.size(), [&, memory = ConeField::Memory(),
                                cover = ConeCover()](std::size_t i) mutable {
        memory.hint = 0;  // of several sources that are equally near the same is found always
        is_kept[i] =
            field.cones().isotropic().cover(leaves[i].box, tolerance, cover, memory.hint) ? 1 : 0;
        const auto sources = cover.sources();
        std::ranges::copy(sources, chosen.begin() + static_cast<std::ptrdiff_t>(i * most));
        count[i] = sources.size();
    });
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        anchors_.set(leaves[i].cell, std::span(chosen).subspan(i * most, count[i]));
    }
    return is_kept;
}

std::vector<SourceIndex> AnchoredValues::lacking(LeafIndex leaf, const Point& x,
                                                 NearbyField& nearby,
                                                 const GoalField& field) const {
    const auto old = anchors_.of(leaf);
    if (old.size() >= most_improved()) return {};
    std::vector<SourceIndex> list(old.begin(), old.end());
    const Known known = known_at(x, nearby, field);
    if (are_order_free()) {
        for (;;) {
            const Metric own = own_at(known, list);
            if (directional_nonconformity(own, known.exact) <= well_within * field.target() ||
                !add_most_exceeded(known, own, list)) {
                break;
            }
        }
    } else {
        std::ranges::copy_if(known.governing, std::back_inserter(list),
                             [&](SourceIndex s) { return std::ranges::find(old, s) == old.end(); });
    }
    if (list.size() == old.size() || list.size() > most_improved()) return {};
    return list;
}

void AnchoredValues::drop_idle_sources() {
    anchors_.shrink_to_fit();
    anchors_.rename(sources_.keep(anchors_.used(sources_.size())));
}

void AnchoredValues::save(StateWriter& state) const {
    if (continuous_) {
        throw InputError(
            "a tree that keeps a continuous field cannot be saved: save one that holds metrics");
    }
    sources_.save(state);
    anchors_.save(state);
    state("anchors.ratio", ratio_);
    state("anchors.largest", largest_.xx);
    state("anchors.intersection", intersection_, IntersectionRule::in_turn);
    state("anchors.fits_tensors_loosely", fits_tensors_loosely_);
    state("anchors.gap", gap_);
}

void AnchoredValues::load(std::size_t leaves, const StateReader& state) {
    sources_.load(state);
    anchors_.load(state, leaves, sources_.size());
    state("anchors.ratio", ratio_);
    state.require(ratio_ >= 1 && ratio_ <= largest_magnitude, "anchors.ratio",
                  "is no gradation ratio");
    double largest = 0;
    state("anchors.largest", largest);
    state.require(is_length(largest), "anchors.largest", "is no length");
    largest_ = Metric::isotropic(largest);
    state("anchors.intersection", intersection_, IntersectionRule::in_turn);
    state("anchors.fits_tensors_loosely", fits_tensors_loosely_);
    state("anchors.gap", gap_);
    state.require(gap_ >= 1e-10 && gap_ <= 1, "anchors.gap", "is out of range");
}

void AnchoredValues::describe(Footprint& footprint) const {
    footprint.control_nodes = anchors_.leaves();
    footprint.bytes_payload = anchors_.bytes() + sources_.bytes();
}

void AnchoredValues::shrink_to_fit() {
    anchors_.shrink_to_fit();
    sources_.shrink_to_fit();
}

}  // namespace controlspace
