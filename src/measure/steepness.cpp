// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/steepness.h"

#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "controlspace/geometry/extent.h"
#include "controlspace/gradation/law.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/space/sample_parallel.h"
#include "geometry/random_fractions.h"
#include "metric/decompose.h"

namespace controlspace {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Vector unit_vector(RandomFractions& fraction) {
    const double z = 2 * fraction() - 1;
    const double angle = 2 * std::numbers::pi * fraction();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

double between_on_log_scale(double low, double high, RandomFractions& fraction) {
    return low * std::pow(high / low, fraction());
}

// As large as a place at `v` is seen from `from`, at least.
void note_growth(const Metric& from, const Metric& to, const Vector& v, Steepness& steepness) {
    const double length = metric_length(from, v);
    if (length == 0) return;
    const double ratio = std::cbrt(to.matrix().determinant() / from.matrix().determinant());
    steepness.det = std::max(steepness.det, Growth{ratio, length}.gradation());
    // The growth of tensors is expensive: computed where it may be the largest.
    if (is_within(to, 1 + (steepness.dir - 1) * length, from)) return;
    steepness.dir = std::max(steepness.dir, Growth{growth(to, from), length}.gradation());
}

}  // namespace

Steepness steepness(const ControlSpace& space, const Box& domain,
                    std::span<const PointSource> sources, std::uint64_t seed, std::size_t pairs) {
    constexpr double nearest = 0.01, farthest = 10;  // to a source
    RandomFractions fraction(seed);
    std::vector<Point> p(pairs), q(pairs);
    std::vector<Vector> ways(pairs);  // from p to q, in metric space
    for (std::size_t i = 0; i < pairs; ++i) {
        for (Axis a = 0; a < 3; ++a) p[i][a] = std::lerp(domain.low[a], domain.high[a], fraction());
        if (i % 2 == 1 && !sources.empty()) {
            const auto k =
                static_cast<std::size_t>(fraction() * static_cast<double>(sources.size()));
            const double away = between_on_log_scale(nearest, farthest, fraction);
            p[i] = nearest_in(domain, sources[k].position + away * (sources[k].metric.matrix() *
                                                                    unit_vector(fraction)));
        }
        ways[i] =
            between_on_log_scale(shortest_pair, longest_pair, fraction) * unit_vector(fraction);
    }
    const auto flat = flat_axis(domain);
    const std::vector<Metric> at_p = sample_parallel(space, p);
    for (std::size_t i = 0; i < pairs; ++i) {
        if (!is_positive_definite(at_p[i])) return {infinity, infinity};
        q[i] = p[i] + at_p[i].matrix() * ways[i];
        if (flat) q[i][*flat] = p[i][*flat];
        if (q[i] != nearest_in(domain, q[i])) q[i] = p[i];  // no pair
    }
    const std::vector<Metric> at_q = sample_parallel(space, q);

    tbb::combinable<Steepness> found;
    tbb::parallel_for(std::size_t{0}, pairs, [&](std::size_t i) {
        Steepness& largest = found.local();
        if (!is_positive_definite(at_q[i])) {
            largest = {infinity, infinity};
            return;
        }
        note_growth(at_p[i], at_q[i], q[i] - p[i], largest);
        note_growth(at_q[i], at_p[i], p[i] - q[i], largest);
    });
    return found.combine([](const Steepness& a, const Steepness& b) {
        return Steepness{std::max(a.det, b.det), std::max(a.dir, b.dir)};
    });
}

}  // namespace controlspace
