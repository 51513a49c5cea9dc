// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"

namespace controlspace {

// Metrics are interpolated linearly in M, as in the paper (§3.1). Other means were compared: f^-1
// of the linear blend of f(M), f(M) kept at the vertices. Octrees whose vertices have the exact
// order-free field (g_r 1.25), cut until the 27 places of each leaf keep δ; "kd" cuts in halves.
// Leaves needed, and, of the tree made for M, the 99th percentile of δ to the field at random
// places, half of them near sources:
//
// |                        | M          | log M      | M^-1       | M^-2       | M^2        |
// |------------------------|------------|------------|------------|------------|------------|
// | sphere [4, 0.25], 0.1  | 4208, 0.25 | 4040, 0.18 | 4047, 0.20 | 4978, 0.34 | 4579, 0.37 |
// | the same, kd           | 1246, 0.25 | 1153, 0.18 | 1182, 0.31 | 1711, 0.61 | 1741, 0.37 |
// | sphere [4, 0.25], 0.3  |  764, 0.96 |  729, 0.85 |  624, 0.78 |  792, 0.82 | 1254, 1.14 |
// | isotropic sphere, 0.1  | 2248, 0.28 | 2192, 0.23 | 2304, 0.20 | 3480, 0.26 | 2808, 0.37 |
// | layers 100:1, capped   |       1.37 |       1.23 |       1.21 |       2.11 |       1.66 |
// | time of a blend        |          1 |         10 |          2 |          9 |         10 |
//
// log M saves 3 to 7 % of the leaves and M^-1 4 to 5 % (18 % for δ 0.3, none for isotropic fields),
// but a blend takes ten times and twice as long: not worth it, where queries are what counts. M^-2
// and M^2 need more leaves. Linear in M is longer than the field at 80 % of these places, by 1.7
// times at worst for δ 0.1; log M at 60 %, by 1.6 times.

/// Weighted mean of `count` metrics, linear in M. `metric_at(i)` returns metric i, a Metric or a
/// StoredMetric, so that structures blend from their own arrays; `weight_at(i)` its weight.
template <class WeightAt, class MetricAt>
[[gnu::always_inline]] inline Metric blend_lengths(std::size_t count, WeightAt&& weight_at,
                                                   MetricAt&& metric_at) {
    // In two vectors of numbers: otherwise the compiler mostly handles them one by one.
    Eigen::Array4d first = Eigen::Array4d::Zero();
    Eigen::Array2d rest = Eigen::Array2d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        const auto& m = metric_at(i);
        const double weight = weight_at(i);
        first += weight * Eigen::Array4d(m.xx, m.yy, m.zz, m.xy);
        rest += weight * Eigen::Array2d(m.xz, m.yz);
    }
    return {first[0], first[1], first[2], first[3], rest[0], rest[1]};
}
template <class MetricAt>
Metric blend_lengths(std::span<const double> weights, MetricAt&& metric_at) {
    return blend_lengths(
        weights.size(), [&](std::size_t i) { return weights[i]; }, metric_at);
}

/// The weighted mean as a Metric; or, where all are known to be isotropic, as its length:
/// StoredLengths too.
template <class Value, class WeightAt, class MetricAt>
[[gnu::always_inline]] inline Value blend(std::size_t count, WeightAt&& weight_at,
                                          MetricAt&& metric_at) {
    using M = std::remove_cvref_t<decltype(metric_at(0))>;
    if constexpr (std::is_same_v<Value, double> || is_stored_length<M>) {
        double length = 0;
        for (std::size_t i = 0; i < count; ++i) length += weight_at(i) * length_of(metric_at(i));
        return isotropic_value<Value>(length);
    } else {
        return blend_lengths(count, weight_at, metric_at);
    }
}

/// The weights of a box's eight corners (x fastest) in a trilinear blend at the place that is the
/// fractions `t` of its edges from its lowest corner.
inline std::array<double, 8> corner_weights(const Vector& t) {
    const std::array<double, 2> wx{1 - t.x(), t.x()}, wy{1 - t.y(), t.y()}, wz{1 - t.z(), t.z()};
    std::array<double, 8> weights{};
    for (std::size_t i = 0; i < 8; ++i) weights[i] = wx[i & 1] * wy[i >> 1 & 1] * wz[i >> 2];
    return weights;
}

}  // namespace controlspace
