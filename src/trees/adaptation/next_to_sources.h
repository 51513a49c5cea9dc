// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "space/goal_field.h"
#include "trees/adaptation/adapted_cells.h"
#include "trees/adaptation/departure.h"
#include "trees/adaptation/single_cones.h"

namespace controlspace {

/// Finds where the metric of a cell exceeds the cone of a single source: there the exact field may
/// have a minimum that no other place of the cell shows.
class NextToSources {
public:
    /// All must outlive it.
    NextToSources(const AdaptedCells& cells, const GoalField& field,
                  std::span<const PointSource> sources);

    /// Before a round of `worst_in`. Few sources are compared with all cells there, many, here,
    /// with those cells beside their own of which `is_wanted(cell)` holds; `is_new(cell)` of all
    /// that have been cut since the last time, at least.
    void find_beside(const std::function<bool(CellIndex)>& is_new,
                     const std::function<bool(CellIndex)>& is_wanted);

    /// The place where the cell exceeds a single cone most, and an estimate of its departure from
    /// the field there; nothing if that is far below the target. Of few sources, appends to
    /// `others` where it exceeds cones, and places around the tips of cones.
    Departure worst_in(const CellBox& of, std::vector<Point>& others) const;

private:
    bool are_few() const;
    std::array<Metric, 8> at_corners(CellIndex cell) const;
    bool may_exceed(std::size_t source, const CellBox& of) const;
    void for_each_cell_beside(const Box& box, const Point& x,
                              const std::function<void(const CellBox&)>& visit) const;

    const AdaptedCells& cells_;
    const GoalField& field_;
    std::span<const PointSource> sources_;
    bool is_trilinear_;
    std::optional<SingleCones> cones_;              // once they are needed
    std::vector<Departure> beside_;                 // of the cells, where sources are many
    std::vector<std::array<CellIndex, 8>> around_;  // each source, then: its cell and those beside
};

}  // namespace controlspace
