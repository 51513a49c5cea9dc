// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/next_to_sources.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trees/adaptation/parameters.h"
#include "trees/in_parallel.h"

namespace controlspace {

NextToSources::NextToSources(const AdaptedCells& cells, const GoalField& field,
                             std::span<const PointSource> sources)
    : cells_(cells),
      field_(field),
      sources_(sources),
      is_trilinear_(cells.model().traits().is_trilinear) {}

// Whether all are compared with every cell, which takes less time where cells are trilinear.
bool NextToSources::are_few() const {
    return field_.has_sources_up_to(is_trilinear_ ? GoalField::few_sources : single_cones::few);
}

void NextToSources::find_beside(const std::function<bool(CellIndex)>& is_new,
                                const std::function<bool(CellIndex)>& is_wanted) {
    if (!cones_) cones_.emplace(sources_, field_.ratio(), field_.target());
    if (are_few()) return;
    beside_.assign(cells_.count(), {});
    tbb::enumerable_thread_specific<std::vector<std::pair<CellIndex, Departure>>> found;
    around_.resize(sources_.size());
    in_parallel(sources_.size(), [&](std::size_t i) {
        // A cell that is cut stays as one of its parts: those not new are as they were.
        if (std::ranges::none_of(around_[i], is_new)) return;
        const CellBox holder = cells_.at(sources_[i].position);
        around_[i].fill(holder.cell);
        std::size_t next = 1;
        for_each_cell_beside(holder.box, sources_[i].position, [&](const CellBox& beside) {
            around_[i][next++] = beside.cell;
            if (!is_wanted(beside.cell) || !may_exceed(i, beside)) return;
            const Departure departure = cones_->at_nearest_place(
                i, beside.box, [&](const Point& x) { return cells_.value(beside.cell, x); });
            if (departure.worst > 0) found.local().emplace_back(beside.cell, departure);
        });
    });
    for (const auto& of_thread : found) {
        for (const auto& [cell, departure] : of_thread) beside_[cell].take(departure);
    }
}

Departure NextToSources::worst_in(const CellBox& of, std::vector<Point>& others) const {
    if (!are_few()) return beside_[of.cell];
    const auto metric_at = [&](const Point& x) { return cells_.value(of.cell, x); };
    // Corners are among the places of the cell, and where it is trilinear, edges are searched.
    cones_->append_around_tips(of.box, is_trilinear_ ? 1 : 2, others);
    if (is_trilinear_) {
        return cones_->worst_in(of.box, at_corners(of.cell), metric_at, &others);
    }
    Departure worst;
    for (std::size_t k = 0; k < sources_.size(); ++k) {
        worst.take(cones_->at_nearest_place(k, of.box, metric_at, &others));
    }
    return worst;
}

std::array<Metric, 8> NextToSources::at_corners(CellIndex cell) const {
    std::array<Metric, 8> metrics;
    const CellModel& model = cells_.model();
    std::ranges::transform(model.corners()[cell], metrics.begin(),
                           [&](NodeIndex node) { return model.metrics()[node]; });
    return metrics;
}

bool NextToSources::may_exceed(std::size_t source, const CellBox& of) const {
    return !is_trilinear_ || cones_->may_be_exceeded(source, of.box, at_corners(of.cell));
}

// Across the nearest faces, edges and corner of the box, which holds x.
void NextToSources::for_each_cell_beside(const Box& box, const Point& x,
                                         const std::function<void(const CellBox&)>& visit) const {
    const Point centre = box.centre();
    const Box domain = cells_.domain();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (int sides = 1; sides < 8; ++sides) {
        Point p = x;
        for (Axis a = 0; a < 3; ++a) {
            if ((sides >> a & 1) == 0) continue;
            p[a] = x[a] < centre[a] ? std::nextafter(box.low[a], -infinity)
                                    : std::nextafter(box.high[a], infinity);
        }
        if (domain.contains(p)) visit(cells_.at(p));
    }
}

}  // namespace controlspace
