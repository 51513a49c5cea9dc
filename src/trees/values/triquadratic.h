// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "controlspace/metric/metric.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// Metric inside a leaf, interpolated from its own metric and those of its six face neighbours.
///
/// `own` is the leaf's metric; across[2 a] and across[2 a + 1] are the neighbours' on the low and
/// high side of axis a (the leaf's own at the domain's border); `t` is the place in the leaf, each
/// coordinate in [-1, 1]. The 27 nodes of a hexahedron are set to: centre: own; face: mean of own
/// and the neighbour's; edge: mean of its two faces; corner: mean of its three faces; between them
/// the triquadratic Lagrange functions (paper §3.1, its coordinates put right).
///
/// Answers `own` at the centre and reproduces a constant. No node is smaller than own / 2, but
/// quadratic functions undershoot; where the result would fall below own / 2 along any direction,
/// its departure from `own` is scaled down until it does not. So it is always positive definite.
///
/// A leaf's face gets the mean of two leaves, far coarser than `own` beside a large neighbour, as
/// beside a source at a cut plane. So the result is intersected with `largest_growth` times `own`,
/// which is at least 1: along each direction by itself, and without a jump where it begins. (Cut
/// off at the coarsest of the seven metrics instead, it is as often coarser than requested, and
/// less accurate.)
Metric triquadratic(const Metric& own, const std::array<Metric, 6>& across, const Vector& t,
                    double largest_growth);

/// How much the metrics of the six neighbours weigh in that, and last the leaf's own.
inline std::array<double, 7> triquadratic_weights(const Vector& t) {
    // The nodes are means of seven metrics, so the sum over 27 nodes is one over seven metrics.
    // On an axis with coordinate s, the functions of the two outer nodes are s(s-1)/2 and s(s+1)/2,
    // and sum to s². With q = s² of the other two axes, the face node of an axis enters by itself
    // (1-q)(1-q'), as half of four edges, q(1-q') + q'(1-q), and as a third of four corners, q q'.
    const Vector q = t.cwiseProduct(t);
    const auto plane = [](double qb, double qc) {
        return (1 - qb) * (1 - qc) + 0.5 * (qb * (1 - qc) + qc * (1 - qb)) + qb * qc / 3;
    };
    const Vector planes(plane(q[1], q[2]), plane(q[2], q[0]), plane(q[0], q[1]));
    // A face node is the mean of the neighbour's metric and the leaf's own.
    const auto low = [&](Axis a) { return 0.25 * t[a] * (t[a] - 1) * planes[a]; };
    const auto high = [&](Axis a) { return 0.25 * t[a] * (t[a] + 1) * planes[a]; };
    std::array<double, 7> weights{low(0), high(0), low(1), high(1), low(2), high(2), 0};
    const double faces =
        weights[0] + weights[1] + (weights[2] + weights[3]) + (weights[4] + weights[5]);
    weights[6] = 1 - faces;
    return weights;
}

/// The same for QuadraticForm::published.
std::array<double, 7> published_triquadratic_weights(const Vector& t);

/// `sum` brought to within what is allowed.
double limited_length(double own, double sum, const Vector& v, double slope);

/// The same for isotropic metrics, given by their lengths, to the bit; the largest growth is that
/// of own's cone of this slope, 1 + slope |v| / own, where `v` is the way from the leaf's centre.
inline double triquadratic(double own, const std::array<double, 6>& across, const Vector& t,
                           const Vector& v, double slope) {
    const std::array<double, 7> weights = triquadratic_weights(t);
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i) sum += weights[i] * across[i];
    sum += weights[6] * own;
    const double departure = sum - own;
    // Most lie so far inside what is allowed that one comparison suffices.
    constexpr double surely = 1 - 1e-12;
    const bool is_deep_enough = departure >= -0.5 * own;
    const bool is_small = departure <= 0;
    const bool is_below_cone = departure * departure <= surely * slope * slope * v.squaredNorm();
    if (is_deep_enough & (is_small | is_below_cone)) return sum;
    return limited_length(own, sum, v, slope);
}

}  // namespace controlspace
