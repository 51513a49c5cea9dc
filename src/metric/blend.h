#pragma once

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
/// `metric_at(i)` gives metric i: structures blend straight from their arrays.
template <class MetricAt>
Metric blend_lengths(std::span<const double> weights, MetricAt&& metric_at) {
    Metric sum{0, 0, 0, 0, 0, 0};
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const Metric& m = metric_at(i);
        const double w = weights[i];
        sum.xx += w * m.xx;
        sum.yy += w * m.yy;
        sum.zz += w * m.zz;
        sum.xy += w * m.xy;
        sum.xz += w * m.xz;
        sum.yz += w * m.yz;
    }
    return sum;
}

/// Weighted mean of `metrics` by the given scheme; the spans must be of equal size.
Metric blend(std::span<const double> weights, std::span<const Metric> metrics,
             Blend scheme = Blend::lengths);

}  // namespace controlspace
