#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cstddef>
#include <span>

#include "metric/metric.h"

namespace controlspace {

/// How metrics are interpolated. With weights that sum to 1, all of them reproduce a constant.
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
/// With other weights than those, "positive definite for" fails in the open: the result of the
/// first three is then not positive definite, or not a number. M^-2 and M^2 keep half the digits of
/// M: at an anisotropy of 1e6 the largest (riemannian) or smallest (inverse) length is good to
/// 1e-3.
///
/// `lengths` is the paper's (§3.1) and the default everywhere.
enum class Blend { lengths, riemannian, inverse, log_euclidean };

/// Weighted mean of `metrics`, linear in M; weights and metrics are of the same number.
/// `metric_at(i)` gives metric i: structures blend straight from their arrays, of Metric or
/// StoredMetric.
template <class MetricAt>
Metric blend_lengths(std::span<const double> weights, MetricAt&& metric_at) {
    // In two vectors of numbers: left alone, the compiler mostly does one number after the other.
    Eigen::Array4d first = Eigen::Array4d::Zero();
    Eigen::Array2d rest = Eigen::Array2d::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto& m = metric_at(i);
        first += weights[i] * Eigen::Array4d(m.xx, m.yy, m.zz, m.xy);
        rest += weights[i] * Eigen::Array2d(m.xz, m.yz);
    }
    return {first[0], first[1], first[2], first[3], rest[0], rest[1]};
}

/// Weighted mean of `metrics` by the given scheme; the spans must be of equal size.
Metric blend(std::span<const double> weights, std::span<const Metric> metrics,
             Blend scheme = Blend::lengths);

}  // namespace controlspace
