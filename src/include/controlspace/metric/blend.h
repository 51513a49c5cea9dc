#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cstddef>
#include <span>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// How metrics are interpolated. With weights that sum to 1, all schemes reproduce a constant.
///
/// | blend          | linear in | positive definite for | what it does badly                    |
/// |----------------|-----------|-----------------------|---------------------------------------|
/// | lengths        | M         | weights >= 0          | lets the large metric win, swells the |
/// |                |           |                       | thin side of crossing anisotropies    |
/// | riemannian     | M^-2      | weights >= 0          | lets the small metric win: too many   |
/// |                |           |                       | elements; two powers per query        |
/// | inverse        | M^2       | weights >= 0          | as lengths, and stronger              |
/// | log_euclidean  | log M     | any weights           | costs an eigen-decomposition a        |
/// |                |           |                       | metric; otherwise the best behaved    |
///
/// With negative weights the result of the first three may not be positive definite, or not a
/// number. M^-2 and M^2 keep half the digits of M: at an anisotropy of 1e6 the largest (riemannian)
/// or smallest (inverse) length is accurate to 1e-3 only.
///
/// `lengths` is the paper's (§3.1) and the default everywhere.
enum class Blend { lengths, riemannian, inverse, log_euclidean };

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

/// Weighted mean of `metrics` by the given scheme; the spans must be of equal size.
Metric blend(std::span<const double> weights, std::span<const Metric> metrics,
             Blend scheme = Blend::lengths);

}  // namespace controlspace
