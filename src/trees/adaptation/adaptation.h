// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "controlspace/space/adaptation.h"
#include "controlspace/space/space_options.h"
#include "space/goal_field.h"
#include "trees/adaptation/adapted_cells.h"
#include "trees/adaptation/cell_judge.h"
#include "trees/adaptation/fit_lengths.h"
#include "trees/adaptation/next_to_sources.h"

namespace controlspace {

/// Cuts cells until each is within the target of a field, wherever it is sampled, or proven to be.
/// It begins with cells that hold nothing yet, mostly one.
class Adaptation {
public:
    /// All must outlive it.
    Adaptation(AdaptedCells& cells, const GoalField& field, const AdaptationGoal& goal,
               const GrowthLimit& limit = {});

    /// Cuts a cell across an axis for which `along` speaks most, and appends to `cut` the numbers
    /// of all cells that it had to cut; false where the cell must stay as it is.
    using Cut = std::function<bool(const CellBox& cell, const std::array<double, 3>& along,
                                   std::vector<CellIndex>& cut)>;

    /// If it `is_searched`, cells are also judged at places that they were not fitted to. Returns
    /// the largest departure that is left; infinite if some cell was not to be cut, and neither
    /// shown to keep the target nor found to exceed it.
    double run(bool is_searched, const Cut& cut);

    /// Whether it ended at the deadline.
    bool is_late() const { return is_late_; }
    /// Whether a target that is met is proven to be kept everywhere.
    bool shows_bounds() const { return cells_.model().has_bounds(field_); }

private:
    enum class State : std::uint8_t { settled, changed, fresh };

    bool round(const Cut& cut);
    bool improve_or_cut(const CellBox& cell, const Cut& cut);
    bool improve(CellIndex cell, std::span<const std::uint32_t> improvement);
    bool improves_without_cut() const;
    std::vector<CellBox> cells_in(State least) const;
    std::vector<Judgement> fit(std::span<const CellBox> cells);
    void fit_values();
    void judge(std::span<const CellBox> cells);
    void sample_sources();
    CellJudge judge_of_cells() const { return {cells_, field_, next_to_sources_, judge_options_}; }

    AdaptedCells& cells_;
    const GoalField& field_;
    const std::size_t max_cells_;
    bool fits_values_;
    LengthFit length_fit_;  // of the cells, where values are fitted
    const GrowthLimit limit_;
    CellJudge::Options judge_options_;
    bool is_late_ = false;
    std::vector<Point> sources_;
    std::vector<Metric> at_sources_;  // the field there
    NextToSources next_to_sources_;
    std::vector<CellIndex> cell_of_source_;
    std::vector<State> states_;                             // of the cells
    std::vector<Judgement> judgements_;                     // likewise
    std::vector<std::array<double, 3>> along_by_field_;     // likewise, where values are fitted
    std::vector<std::vector<std::uint32_t>> improvements_;  // likewise
    std::uint64_t places_used_ = 0;
};

}  // namespace controlspace
