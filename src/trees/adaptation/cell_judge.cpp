// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/cell_judge.h"

#include <algorithm>
#include <cmath>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/nonconformity.h"
#include "geometry/place_sequence.h"
#include "space/goal_field.h"
#include "trees/adaptation/parameters.h"

namespace controlspace {

// How a cell is judged where nothing is proven. Its error is largest
// - where its own interpolation is worst: at its corners, the middles of its edges and of its
//   faces, and its centre (LeafPlaces), of which some show across which axis a cut helps;
// - at sources in it, and where the tip of a cone beside it touches it (NextToSources);
// - along creases, where one cone takes over from another: anywhere, mostly across faces and edges.
//   The last is searched at places of a sequence, and by climbs from the worst that was found.
// Cells that exceed the target are found early, and left then: each step is for those that seem to
// be within it.

namespace {

// Of the largest factor of lengths in one direction.
double logarithm_of(double delta) { return std::log(largest_factor_along(delta)); }

double change(const Metric& from, const Metric& to) { return std::log(largest_ratio(from, to)); }

// Between the corners.
std::array<double, 3> change_along(std::span<const Metric> field) {
    std::array<double, 3> along{};
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t c = 0; c < 8; ++c) {
            if ((c >> a & 1) != 0) continue;
            along[a] += change(field[c], field[c | std::size_t{1} << a]);
        }
    }
    return along;
}

}  // namespace

CellJudge::CellJudge(const AdaptedCells& cells, const GoalField& field,
                     const NextToSources& next_to, const Options& options)
    : cells_(cells),
      field_(field),
      next_to_sources_(next_to),
      options_(options),
      bounds_(options.is_searched && cells.model().has_bounds(field)),
      is_trilinear_(cells.model().traits().is_trilinear),
      cut_by_(cells.model().traits().cut_by),
      nearby_(field) {}

Judgement CellJudge::judge(const CellBox& cell, const Known& known) {
    known_ = known;
    enter(cell);
    return cells_.model().judge(cell, *this);
}

CellJudge::Findings CellJudge::begin(const CellBox& cell) const {
    Findings found(cell);
    if (known_.at_sources > 0) found.take(known_.at_sources, known_.source);
    return found;
}

Judgement CellJudge::judgement(const Findings& found) const {
    const Departure& d = found.departure;
    return {is_exceeded(found) ? Judgement::Verdict::exceeded : Judgement::Verdict::kept, d.worst,
            d.where, d.along};
}

Judgement CellJudge::by_samples(const CellBox& cell) {
    Findings found = begin(cell);
    // Where an axis is to be chosen, what is above the target already is compared at these places
    // too.
    if (known_.is_fresh && !cells_.model().is_fitted(cell.cell) &&
        (cells_.chooses_axis() || !is_exceeded(found))) {
        at_places_of(cell, found);
    }
    if (!is_exceeded(found)) {
        std::vector<Point> others;
        const Departure estimate = next_to_sources_.worst_in(cell, others);
        examine(cell, estimate, others, found);
    }
    if (options_.is_searched && !is_exceeded(found)) search(cell, found);
    return judgement(found);
}

// First the bounds: where they prove that the target is kept, nothing else is needed.
Judgement CellJudge::by_bounds(const CellBox& cell, const std::array<double, 8>& at_corners) {
    Findings found = begin(cell);
    std::optional<NearbyField::Doubt> doubt;
    const bool is_open = !is_exceeded(found);
    double above = 0;  // at the place of the doubt, where it is certain
    if (is_open) {
        doubt = nearby_.doubt_of(at_corners);
        if (!doubt) {
            found.take(options_.target, cell.box.centre());
            return judgement(found);
        }
        if (doubt->is_certain) {
            const Metric held = cells_.value(cell.cell, doubt->where);
            above = nonconformity(held, nearby_.at(doubt->where));
        }
    }
    if (known_.is_fresh && (cells_.chooses_axis() || is_open)) at_places_of(cell, found);
    if (!is_open || is_exceeded(found)) return judgement(found);
    found.departure.take(above, doubt->where);
    Judgement judged = judgement(found);
    if (!is_exceeded(found)) {
        judged.verdict = Judgement::Verdict::unknown;
        judged.where = doubt->where;
    }
    return judged;
}

std::vector<std::uint32_t> CellJudge::improvement(const CellBox& cell, const Point& x) {
    return cells_.model().improvement(cell.cell, x, nearby_, field_);
}

std::optional<Judgement> CellJudge::above_target_at_some_places(const CellBox& cell) {
    enter(cell);
    Findings found(cell);
    at_sequence(cell, 0, sampling::places_of_unknown, found);
    if (!(found.departure.worst > field_.target())) return std::nullopt;
    const Departure& d = found.departure;
    return Judgement{Judgement::Verdict::exceeded, d.worst, d.where, d.along};
}

// The others are skipped where some of them show that the cell has to be cut, and how.
void CellJudge::at_places_of(const CellBox& of, Findings& found) {
    Compared compared;
    const auto all = ranges(cut_by_);
    for (std::size_t r = 0; r < all.size(); ++r) {
        const bool is_shared = r < shared_ranges(cells_);
        compare_at(of, all[r], is_shared ? NearbyField::Cones::shared : NearbyField::Cones::all,
                   found, compared);
        if (is_exceeded(found)) break;
    }
    if (cells_.chooses_axis()) found.departure.along = sums_along(compared);
}

// For the worst place of a cell that seems to be within the target.
void CellJudge::search(const CellBox& of, Findings& found) {
    at_sequence(of, known_.first_place, known_.end_place, found);
    const auto is_near = [&](double share) {
        const double worst = found.departure.worst;
        return options_.is_thorough && worst > share * options_.target && !is_exceeded(found);
    };
    const double slope = field_.largest_ratio() - 1;
    // Where the field has a crease across an edge, the middle of that shows little of it.
    if (is_near(sampling::share_between)) at_places_between(of, found);
    if (is_trilinear_ && is_near(0)) along_edges(of, slope, found);
    if (is_near(sampling::share_for_more)) {
        at_sequence(of, known_.end_place, known_.end_place + sampling::more_places, found);
    }
    climb(of, slope, found);
}

// At places number `first` to `end - 1` of the sequence in a box that is larger than the cell.
void CellJudge::at_sequence(const CellBox& of, std::uint64_t first, std::uint64_t end,
                            Findings& found) {
    std::array<Point, LeafPlaces::all> x;
    const Vector beyond = sampling::reach_beyond * of.box.edges();
    const Box box{of.box.low - beyond, of.box.high + beyond};
    while (first < end) {
        const std::size_t n = std::min<std::uint64_t>(x.size(), end - first);
        for (std::size_t i = 0; i < n; ++i) x[i] = nearest_in(of.box, place_in(box, first++));
        compare_with(of, std::span(x).first(n), NearbyField::Cones::close, found);
    }
}

// On its faces, between the places of the cell; on its edges too, where `along_edges` is not for
// it.
void CellJudge::at_places_between(const CellBox& of, Findings& found) {
    std::array<Point, LeafPlaces::between_on_edges> x;
    std::size_t first = is_trilinear_ ? LeafPlaces::between_on_edges : 0;
    for (; first < LeafPlaces::between; first += x.size()) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i] = of.box.low + leaf_places().at_between[first + i].cwiseProduct(of.box.edges());
        }
        compare_with(of, x, NearbyField::Cones::close, found);
    }
}

// Along its edges, where the field is that of the cell at the corners: in the middle of parts of
// them, as long as some part is so long, in the metrics at its ends, that the target may be
// exceeded in it. The logarithm of a length changes by the slope of cones, at most, per unit.
void CellJudge::along_edges(const CellBox& of, double slope, Findings& found) {
    struct Part {
        double from, to;
        std::array<double, 2> logarithm, size;  // at the ends: of a factor; of the whole edge
        double most(double slope) const {
            const double units = (to - from) * std::max(size[0], size[1]);
            return 0.5 * (logarithm[0] + logarithm[1] + slope * units);
        }
    };
    constexpr std::size_t most_parts = sampling::parts_of_edge;
    const double allowed = logarithm_of(options_.target);
    for (int edge = 0; edge < 12; ++edge) {
        const Axis axis = edge % 3;
        const int side = edge / 3;
        Point low = of.box.low;
        low[(axis + 1) % 3] = ((side & 1) != 0 ? of.box.high : of.box.low)[(axis + 1) % 3];
        low[(axis + 2) % 3] = ((side & 2) != 0 ? of.box.high : of.box.low)[(axis + 2) % 3];
        Point high = low;
        high[axis] = of.box.high[axis];
        std::array<Metric, 2> ends;
        cells_.values(of.cell, std::array{low, high}, ends);
        const Vector along = high - low;
        std::array<Part, most_parts> parts;
        parts[0] = {0, 1, {0, 0}, {metric_length(ends[0], along), metric_length(ends[1], along)}};
        for (std::size_t count = 1; count < most_parts; ++count) {
            Part& part = *std::ranges::max_element(parts.begin(), parts.begin() + count, {},
                                                   [&](const Part& p) { return p.most(slope); });
            if (part.most(slope) <= allowed) break;
            const double middle = 0.5 * (part.from + part.to);
            const Point x = low + middle * along;
            const Metric held = cells_.value(of.cell, x);
            Metric field;
            const NearbyField::Accuracy accuracy =
                nearby_.evaluate_roughly({&x, 1}, NearbyField::Cones::close, {&field, 1});
            compare(held, field, accuracy, x, found);
            if (is_exceeded(found)) return;
            const double logarithm = logarithm_of(directional_nonconformity(held, field));
            const double size = metric_length(field, along);
            parts[count] = part;
            parts[count].from = part.to = middle;
            parts[count].logarithm[0] = part.logarithm[1] = logarithm;
            parts[count].size[0] = part.size[1] = size;
        }
    }
}

// At a place where the error is estimated, and at others until one is above the target; far above
// it the estimate will do.
void CellJudge::examine(const CellBox& of, const Departure& estimate, std::span<const Point> others,
                        Findings& found) {
    if (estimate.worst > sampling::far_above * options_.target) {
        return found.take(estimate.worst, estimate.where);
    }
    if (estimate.worst > 0) {
        compare_with(of, {&estimate.where, 1}, NearbyField::Cones::close, found);
    }
    while (!others.empty() && !is_exceeded(found)) {
        const std::size_t n = std::min<std::size_t>(others.size(), LeafPlaces::all);
        compare_with(of, others.first(n), NearbyField::Cones::close, found);
        others = others.subspan(n);
    }
}

// Local maximisation of the error, started at the largest sampled error; if it is thorough, at all
// peaks that were found. A start is abandoned if it stays far below the target, if the slope of
// cones shows that it cannot reach the target within its reach, or beside the summit of a climb
// before that is as high. Places are chosen all around, for what is climbed has creases, where
// other cones begin to matter, and no gradient there.
void CellJudge::climb(const CellBox& of, double slope, Findings& found) {
    using namespace climbing;
    std::array<Point, tries> x;
    std::uint64_t next = 0;
    Peaks starts = found.peaks;
    const std::span<const Peaks::Peak> sorted = starts.sorted();
    const bool thorough = options_.is_thorough;
    const double target = options_.target;
    const std::size_t most = thorough ? Peaks::most : 1;
    Peaks summits(of.box);
    for (const Peaks::Peak& start : sorted.first(std::min(most, sorted.size()))) {
        Findings climbed(of);
        climbed.departure.take(start.delta, start.where);
        Departure& best = climbed.departure;
        Vector reach = climbing::first_reach * of.box.edges();
        for (int round = 0; round < (thorough ? rounds + fine_rounds : rounds); ++round) {
            if (is_exceeded(found)) return;
            const double near =
                std::max(std::min(share_at_first + rise * round, share_in_time),
                         std::min(0.5 * (1 + static_cast<double>(round) / rounds), share_at_last));
            if (!(best.worst > near * target)) break;
            if (summits.has_beside(best.worst, best.where)) break;
            if (round == rounds) reach = fine_reach * of.box.edges();
            // The logarithm of a length changes by the slope of cones, at most, per unit; that of
            // the cell's own by about as much.
            const Metric held = cells_.value(of.cell, best.where);
            const auto units = metric_edge_lengths(held, reach);
            const double attainable =
                logarithm_of(best.worst) + 2 * slope * (units[0] + units[1] + units[2]);
            if (!(attainable > logarithm_of(target))) {
                if (round >= rounds) break;
                round = rounds - 1;
                continue;
            }
            // From a face, which creases cross, most stay on it; from an edge, on it or on one of
            // its faces.
            const auto is_on_face = [&, at = best.where](Axis a) {
                return at[a] == of.box.low[a] || at[a] == of.box.high[a];
            };
            const int faces = is_on_face(0) + is_on_face(1) + is_on_face(2);
            for (int i = 0; i < tries; ++i) {
                const Vector side = i % 2 == 0 ? reach : nearer * reach;
                const Box around{best.where - side, best.where + side};
                Point& y = x[static_cast<std::size_t>(i)];
                y = nearest_in(of.box, place_in(around, next++));
                int faces_to_left = faces == 2 && i > 2 ? (i + round) % 2 : -1;
                for (Axis a = 0; a < 3 && i > 1 && faces < 3; ++a) {
                    if (is_on_face(a) && faces_to_left-- != 0) y[a] = best.where[a];
                }
            }
            const double before = best.worst;
            compare_with(of, x, NearbyField::Cones::close, climbed);
            if (!(best.worst > before)) reach *= round < rounds ? shrink : fine_shrink;
            found.departure.take(best.worst, best.where);
        }
        summits.enter(best.worst, best.where);
    }
}

std::span<const CellJudge::Range> CellJudge::ranges(CutBy cut_by) {
    using P = LeafPlaces;
    static constexpr std::array by_corners{Range{P::corners, P::faces}, Range{P::faces, P::edges}};
    static constexpr std::array by_edges{Range{P::edges, P::all}, Range{P::centre, P::edges}};
    static constexpr std::array by_faces{Range{P::centre, P::edges}, Range{P::corners, P::centre},
                                         Range{P::edges, P::all}};
    static constexpr std::array by_length{Range{P::corners, P::faces}, Range{P::faces, P::all}};
    switch (cut_by) {
        case CutBy::corners:
            return by_corners;
        case CutBy::edges:
            return by_edges;
        case CutBy::faces:
            return by_faces;
        case CutBy::longest_edge:
            break;
    }
    return by_length;
}

// Of octants all; parts of halves have none of the others.
std::size_t CellJudge::shared_ranges(const AdaptedCells& cells) {
    return cells.chooses_axis() ? 1 : ranges(cells.model().traits().cut_by).size();
}

void CellJudge::compare_at(const CellBox& of, const Range& range, NearbyField::Cones cones,
                           Findings& found, Compared& compared) {
    std::array<Point, LeafPlaces::all> x;
    const std::size_t n = range.to - range.from;
    for (std::size_t i = 0; i < n; ++i) x[i] = leaf_places().in(of.box, range.from + i);
    compare_with(of, std::span(x).first(n), cones, found,
                 std::span(compared.held).subspan(range.from, n),
                 std::span(compared.field).subspan(range.from, n));
}

void CellJudge::compare_with(const CellBox& of, std::span<const Point> x, NearbyField::Cones cones,
                             Findings& found) {
    Compared compared;
    compare_with(of, x, cones, found, std::span(compared.held).first(x.size()),
                 std::span(compared.field).first(x.size()));
}

void CellJudge::compare_with(const CellBox& of, std::span<const Point> x, NearbyField::Cones cones,
                             Findings& found, std::span<Metric> held, std::span<Metric> field) {
    cells_.values(of.cell, x, held);
    const NearbyField::Accuracy accuracy = nearby_.evaluate_roughly(x, cones, field);
    for (std::size_t i = 0; i < x.size(); ++i) compare(held[i], field[i], accuracy, x[i], found);
}

// What may be near to the target, and is the worst so far, is evaluated exactly.
void CellJudge::compare(const Metric& held, const Metric& field,
                        const NearbyField::Accuracy& accuracy, const Point& x, Findings& found) {
    const double target = options_.target;
    switch (accuracy.kind) {
        case NearbyField::Accuracy::Kind::exact:
            return found.take(directional_nonconformity(held, field), x);
        case NearbyField::Accuracy::Kind::estimate: {
            Metric exact = field;
            double delta = directional_nonconformity(held, exact);
            const double most = delta + comparing::error_of_estimate * target;
            if (most > std::max(target, found.departure.worst) &&
                !(delta > comparing::surely_above * target)) {
                nearby_.evaluate({&x, 1}, {&exact, 1});
                delta = directional_nonconformity(held, exact);
            }
            return found.take(delta, x);
        }
        case NearbyField::Accuracy::Kind::at_most_longer:
            break;
    }
    const double from_longest = nonconformity(held, field);
    const Metric shortest = (1 / accuracy.factor) * field;
    const double from_shortest = nonconformity(held, shortest);
    const double most = std::max(from_longest, from_shortest);
    if (most <= comparing::surely_below * target) return found.take(most, x);
    const double least = std::min(from_longest, from_shortest);
    const bool is_outside = held.xx > field.xx || held.xx < shortest.xx;
    if (is_outside && least > target) return found.take(least, x);
    Metric exact;
    nearby_.evaluate({&x, 1}, {&exact, 1});
    found.take(nonconformity(held, exact), x);
}

// Axes across which the field changes, or departs from the cell's own, most.
std::array<double, 3> CellJudge::sums_along(const Compared& compared) const {
    const auto& [held, field] = compared;
    if (cut_by_ == CutBy::corners) return change_along(field);
    const auto departure = [&](std::size_t i) { return change(held[i], field[i]); };
    std::array<double, 3> along{};
    for (std::size_t a = 0; a < 3; ++a) {
        if (cut_by_ == CutBy::faces) {
            along[a] = departure(LeafPlaces::low_face(a)) + departure(LeafPlaces::high_face(a));
        } else if (cut_by_ == CutBy::edges) {
            for (std::size_t i = LeafPlaces::edges; i < LeafPlaces::all; ++i) {
                if (leaf_places().at[i][static_cast<Axis>(a)] == 0.5) along[a] += departure(i);
            }
        }
    }
    return along;
}

std::array<double, 3> change_along(const Box& box, NearbyField& nearby) {
    constexpr std::size_t n = LeafPlaces::faces;  // corners and centre
    std::array<Point, n> x;
    for (std::size_t i = 0; i < n; ++i) x[i] = leaf_places().in(box, i);
    std::array<Metric, n> field;
    nearby.evaluate_roughly(x, NearbyField::Cones::shared, field);
    return change_along(field);
}

}  // namespace controlspace
