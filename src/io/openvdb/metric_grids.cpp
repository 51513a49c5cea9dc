// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/metric_grids.h"

#include <algorithm>
#include <cmath>

namespace controlspace {
namespace {

using Values = std::array<double, 3>;

Values smallest(const Metric&, const EigenFrame& frame) { return {frame.lengths[0], 0, 0}; }

const MetricGrid grids[] = {
    {"density", GridKind::fog,
     "refinement: 1 where the smallest length is finest, 0 where coarsest", smallest},
    {lengths_grid, GridKind::number, "smallest length", smallest},
    {"h_max", GridKind::number, "largest length",
     [](const Metric&, const EigenFrame& frame) {
         return Values{frame.lengths[2], 0, 0};
     },
     lengths_grid},
    {"h_mean", GridKind::number, "mean of the three lengths",
     [](const Metric& m, const EigenFrame&) {
         return Values{mean_length(m), 0, 0};
     },
     lengths_grid},
    {"anisotropy", GridKind::number, "largest length / smallest length",
     [](const Metric&, const EigenFrame& frame) {
         return Values{frame.lengths[2] / frame.lengths[0], 0, 0};
     }},
    {"sizes", GridKind::tuple, "the three lengths, ascending",
     [](const Metric&, const EigenFrame& frame) { return frame.lengths; }},
    {"e1", GridKind::direction, "direction of the smallest length; 0 where all are the same",
     [](const Metric& m, const EigenFrame& frame) {
         if (is_isotropic(m)) return Values{0, 0, 0};
         Vector e = frame.directions.col(0);
         // Of the two directions the one whose largest component is positive.
         Axis largest = 0;
         e.cwiseAbs().maxCoeff(&largest);
         if (e[largest] < 0) e = -e;
         return Values{e.x(), e.y(), e.z()};
     }},
    {diagonal_grid, GridKind::tuple, "xx, yy, zz of the metric tensor (of lengths)",
     [](const Metric& m, const EigenFrame&) {
         return Values{m.xx, m.yy, m.zz};
     },
     "sizes"},
    {off_diagonal_grid, GridKind::tuple, "xy, xz, yz of the metric tensor (of lengths)",
     [](const Metric& m, const EigenFrame&) {
         return Values{m.xy, m.xz, m.yz};
     }},
};

}  // namespace

std::span<const MetricGrid> metric_grids() { return grids; }

double density_of(double h, double finest, double coarsest) {
    if (!(finest < coarsest)) return 1;
    return std::clamp(std::log(coarsest / h) / std::log(coarsest / finest), 0.0, 1.0);
}

double length_of_density(double density, double finest, double coarsest) {
    return coarsest * std::pow(finest / coarsest, std::clamp(density, 0.0, 1.0));
}

}  // namespace controlspace
