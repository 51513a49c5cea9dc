// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

// What answers are judged by: sums over all sources in long double, without any code of the
// structures or of the metric algebra. Metrics are 3x3 matrices here, by rows.

using Real = long double;
using Tensor = std::array<Real, 9>;

Tensor tensor(const Metric& m);
/// Whether all leading minors are positive.
bool oracle_is_positive_definite(const Metric& m);
/// By how much the source's metric has grown at `p`: 1 + (g - 1) |M^-1 (p - Q)| (paper §5.2), with
/// the source's own ratio if it has one.
Real oracle_factor(const PointSource& source, double g, const Point& p);
/// The least k with `m` <= k `limit`, both positive definite: k `limit` - `m` is positive
/// semidefinite then. Metrics blended linearly, each of them at most k `limit`, are at most that.
Real oracle_excess(const Metric& m, const Metric& limit);
/// log det M: what the order-free intersection makes as large as cones allow.
Real oracle_log_volume(const Metric& m);
/// The larger one of `largest` and all cones at `p`, intersected one after the other, forwards or
/// backwards: each is within all of them.
Real oracle_log_volume_in_turn(std::span<const PointSource> sources, double g,
                               const Metric& largest, const Point& p);
/// The exact field of isotropic sources, at most `largest`.
Real oracle_length(std::span<const PointSource> sources, double g, double largest, const Point& p);

}  // namespace controlspace
