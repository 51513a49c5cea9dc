// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/adaptation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/sample_parallel.h"
#include "trees/adaptation/parameters.h"
#include "trees/in_parallel.h"

namespace controlspace {

// The loop: cells that are new are fitted to the field; all that have changed are judged; those
// that are not kept are improved, where their model can, or cut; until none is left that may be
// cut. Three ways to know how well a cell follows the field, the surest that there is:
// - `fit` judges at once, from bounds of the field in the whole cell (constant cells, anchors);
// - `judge` proves it by bounds, or disproves it at a place (trilinear lengths);
// - `judge` samples it. What is sampled may be exceeded between samples: leaves of few sources are
//   cut from 0.96 of the target on, so that a peak that is missed by that is still within it.

using Verdict = Judgement::Verdict;

Adaptation::Adaptation(AdaptedCells& cells, const GoalField& field, const AdaptationGoal& goal,
                       const GrowthLimit& limit)
    : cells_(cells),
      field_(field),
      max_cells_(goal.max_leaves),
      fits_values_(goal.values == NodeValues::fitted),
      length_fit_(field),
      limit_(limit),
      next_to_sources_(cells, field, goal.sources) {
    if (field.has_ranges()) {
        for (const std::uint32_t i : field.kept()) sources_.push_back(goal.sources[i].position);
    } else {
        for (const PointSource& source : goal.sources) sources_.push_back(source.position);
        std::ranges::copy_if(goal.places, std::back_inserter(sources_),
                             [&](const Point& x) { return cells.domain().contains(x); });
    }
    at_sources_.resize(sources_.size());
    sample_parallel(field, sources_, at_sources_);
    cell_of_source_.resize(sources_.size(), 0);
}

double Adaptation::run(bool is_searched, const Cut& cut) {
    const bool are_few = field_.has_few_sources();
    // Halves may be long along axes where a continuous field hardly changes; octants are small, and
    // many.
    const bool is_known = field_.is_order_free() || field_.has_ranges();
    const bool is_thorough = is_searched && !shows_bounds() &&
                             (are_few || is_known || (cells_.chooses_axis() && !field_.jumps()));
    const double share = are_few ? cutting::share_of_few : cutting::share_of_many;
    judge_options_ = {(is_thorough ? share : 1) * field_.target(), is_searched, is_thorough};
    states_.assign(cells_.count(), State::fresh);
    judgements_.resize(cells_.count());
    while (round(cut)) {
    }
    // Neighbours may have been cut after a cell was judged.
    const bool judges_again = is_searched && cells_.model().traits().follows_neighbours;
    for (int k = 0; judges_again && !is_late_ && k < cutting::rounds_of_all; ++k) {
        states_.assign(cells_.count(), State::changed);
        while (round(cut)) {
        }
    }
    double left = 0;
    for (const Judgement& judged : judgements_) {
        const bool is_known_to = judged.verdict != Verdict::unknown;
        left = std::max(left, is_known_to ? judged.delta : std::numeric_limits<double>::infinity());
    }
    return left;
}

// Fits cells that are new, judges all that have changed, and improves or cuts those that are not
// kept. Returns whether some have to be judged again.
bool Adaptation::round(const Cut& cut) {
    field_.forget_if_full();
    if (fits_values_) fit_values();
    std::vector<CellBox> open = cells_in(State::changed);
    judge(open);
    if (fits_values_) {
        for (const CellBox& c : open) judgements_[c.cell].along = along_by_field_[c.cell];
    }
    for (const CellBox& c : open) states_[c.cell] = State::settled;
    is_late_ = limit_.is_late();
    if (is_late_) return false;
    if (cells_.count() + cells_.most_parts() * open.size() > max_cells_) {
        // There may not be enough for all: the worst first.
        std::ranges::stable_sort(open, std::greater(), [&](const CellBox& c) {
            const Judgement& judged = judgements_[c.cell];
            const bool is_unknown = judged.verdict == Verdict::unknown;
            return std::tuple(is_unknown, is_unknown ? 0 : judged.delta);
        });
    }
    bool changes = false;
    for (const CellBox& c : open) {
        // It may have been cut to make way for a neighbour.
        if (states_[c.cell] != State::settled) continue;
        changes = improve_or_cut(c, cut) || changes;
    }
    return changes;
}

bool Adaptation::improve_or_cut(const CellBox& cell, const Cut& cut) {
    if (!improvements_.empty() && improve(cell.cell, improvements_[cell.cell])) return true;
    Judgement& judged = judgements_[cell.cell];
    if (judged.verdict == Verdict::kept) return false;
    std::vector<CellIndex> cells;
    const bool is_cut = cut(cell, judged.along, cells);
    if (!is_cut && improves_without_cut() &&
        judged.delta > cutting::far_off * judge_options_.target) {
        CellJudge judge = judge_of_cells();
        judge.enter(cell);
        if (improve(cell.cell, judge.improvement(cell, judged.where))) return true;
    }
    if (!is_cut && judged.verdict == Verdict::unknown && !limit_.is_late()) {
        const auto found = judge_of_cells().above_target_at_some_places(cell);
        if (found) judged = *found;
    }
    judgements_.resize(cells_.count());
    states_.resize(cells_.count(), State::fresh);
    for (const CellIndex c : cells) states_[c] = State::fresh;
    return is_cut;
}

bool Adaptation::improve(CellIndex cell, std::span<const std::uint32_t> improvement) {
    if (improvement.empty()) return false;
    cells_.model().improve(cell, improvement);
    states_[cell] = State::changed;
    return true;
}

// What is too short to be cut, and far off beside a steep cone.
bool Adaptation::improves_without_cut() const {
    return cells_.model().improves() && !judge_options_.is_searched;
}

// Those in this state, or in a later one.
std::vector<CellBox> Adaptation::cells_in(State least) const {
    return cells_.where([&](CellIndex cell) { return states_[cell] >= least; });
}

std::vector<Judgement> Adaptation::fit(std::span<const CellBox> cells) {
    CellModel& model = cells_.model();
    // Where cells will be compared with the field, as far as they share the places. (Models that
    // are improved evaluate it where they are fitted.)
    if (!model.improves()) {
        const auto ranges = CellJudge::ranges(model.traits().cut_by);
        for (const auto& range : ranges.first(CellJudge::shared_ranges(cells_))) {
            evaluate_shared(field_, cells, range.from, range.to);
        }
    }
    auto judgements = model.fit(cells, {field_, field_, judge_options_.is_searched});
    model.graded(field_.largest_ratio());
    return judgements;
}

// Cells share the nodes that are fitted: with each cut all are fitted anew, and are to be judged.
// Across which axis a cut helps is shown by the field's own values, before they are fitted.
void Adaptation::fit_values() {
    const std::vector<CellBox> fresh = cells_in(State::fresh);
    judge(fresh);
    along_by_field_.resize(cells_.count());
    std::vector<std::uint32_t> numbers;
    std::vector<Box> boxes;
    for (const CellBox& c : fresh) {
        along_by_field_[c.cell] = judgements_[c.cell].along;
        numbers.push_back(c.cell);
        boxes.push_back(c.box);
    }
    std::ranges::fill(states_, State::changed);
    CellModel& model = cells_.model();
    if (cells_.count() > LengthFit::most_cells) {
        fits_values_ = false;  // from now on: the field's own
        model.fit(cells_in(State::settled), {field_, field_, judge_options_.is_searched});
        return;
    }
    length_fit_.enter(numbers, boxes);
    std::vector<double> lengths(model.metrics().size());
    length_fit_.fit(model.corners(), largest_factor_within(field_.target()), lengths);
    for (std::size_t n = 0; n < lengths.size(); ++n) {
        model.metrics().set(n, Metric::isotropic(lengths[n]));
    }
}

// At their own places, if fresh, and, if they are searched, at places that none has been fitted to:
// some in each cell, more in a large one, and the more the closer the target.
void Adaptation::judge(std::span<const CellBox> cells) {
    improvements_.clear();
    if (cells.empty()) return;
    const std::vector<CellBox> fresh = cells_in(State::fresh);
    if (const std::vector<Judgement> by_bounds = fit(fresh); !by_bounds.empty()) {
        for (std::size_t i = 0; i < fresh.size(); ++i) judgements_[fresh[i].cell] = by_bounds[i];
        return;
    }
    const double places_in_domain =
        std::min(sampling::places_times_target / field_.target(), sampling::most_places_in_domain);
    const double whole = measure(cells_.domain());
    std::vector<std::uint64_t> first(cells.size() + 1, places_used_);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const double share = measure(cells[i].box) / whole;
        first[i + 1] = first[i] + sampling::least_places_in_cell +
                       static_cast<std::uint64_t>(share * places_in_domain);
    }
    places_used_ = first.back();
    for (const CellBox& c : cells) judgements_[c.cell] = {};
    sample_sources();
    const CellModel& model = cells_.model();
    const double target = judge_options_.target;
    CellJudge judge_of_all = judge_of_cells();
    if (!judge_of_all.may_use_bounds()) {
        const auto is_new = [&](CellIndex cell) { return states_[cell] != State::settled; };
        next_to_sources_.find_beside(is_new, [&](CellIndex cell) {
            return is_new(cell) && !(judgements_[cell].delta > target);
        });
    }
    // In gradation, each of few tensors is compared with each cell: cuts until all of them are met
    // would make as many cells as the cube of their number.
    const bool improves = model.improves() && (judge_options_.is_searched ||
                                               ((field_.is_order_free() || field_.jumps()) &&
                                                field_.has_sources_up_to(single_cones::few)));
    if (improves) improvements_.resize(cells_.count());
    const double to_improve = (judge_options_.is_searched ? cutting::share_to_improve : 1) * target;
    in_parallel(cells.size(), [&, judge = judge_of_all](std::size_t i) mutable {
        const CellBox& c = cells[i];
        Judgement& judged = judgements_[c.cell];
        if (limit_.is_late()) {
            judged.verdict = Verdict::unknown;
            return;
        }
        judged = judge.judge(c, {states_[c.cell] == State::fresh, judged.delta, judged.where,
                                 first[i], first[i + 1]});
        if (improves && (judged.verdict != Verdict::kept || judged.delta > to_improve)) {
            improvements_[c.cell] = judge.improvement(c, judged.where);
        }
    });
}

// Raises what is known of cells that are not settled by the sources in them.
void Adaptation::sample_sources() {
    std::vector<double> of_source(sources_.size(), 0);
    in_parallel(sources_.size(), [&](std::size_t i) {
        // A cell that is cut stays as one of its parts, which is fresh.
        CellIndex& cell = cell_of_source_[i];
        if (states_[cell] == State::settled) return;
        cell = cells_.number_at(sources_[i]);
        of_source[i] = directional_nonconformity(cells_.value(cell, sources_[i]), at_sources_[i]);
    });
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        Judgement& judged = judgements_[cell_of_source_[i]];
        if (!(of_source[i] > judged.delta)) continue;
        judged.delta = of_source[i];
        judged.where = sources_[i];
    }
}

}  // namespace controlspace
