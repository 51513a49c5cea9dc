// SPDX-License-Identifier: Apache-2.0
#include "trees/values/triquadratic.h"

#include <Eigen/Eigenvalues>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

namespace {

Metric difference(const Metric& a, const Metric& b) {
    return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.xz - b.xz, a.yz - b.yz};
}

Metric moved(const Metric& from, double factor, const Metric& by) {
    return difference(from, -factor * by);
}

// The largest share of `departure` that leaves own + share * departure at or above own / 2.
double admissible_share(const Metric& own, const Metric& departure) {
    if (is_axis_aligned(own) && is_axis_aligned(departure)) {
        const double deepest =
            std::min({departure.xx / own.xx, departure.yy / own.yy, departure.zz / own.zz});
        return deepest >= -0.5 ? 1 : -0.5 / deepest;
    }
    if (is_positive_definite(moved(0.5 * own, 1, departure))) return 1;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> relative(
        departure.matrix(), own.matrix(), Eigen::EigenvaluesOnly);
    const double deepest = relative.eigenvalues().minCoeff();
    return deepest >= -0.5 ? 1 : -0.5 / deepest;
}

// The same of lengths.
double admissible_share(double own, double departure) {
    const double deepest = departure / own;
    return deepest >= -0.5 ? 1 : -0.5 / deepest;
}

}  // namespace

Metric triquadratic(const Metric& own, const std::array<Metric, 6>& across, const Vector& t,
                    double largest_growth) {
    const std::array<double, 7> weights = triquadratic_weights(t);
    const Metric sum = blend_lengths(
        weights, [&](std::size_t i) -> const Metric& { return i < 6 ? across[i] : own; });

    const Metric departure = difference(sum, own);
    const double share = admissible_share(own, departure);
    const Metric deep_enough = share >= 1 ? sum : moved(own, share, departure);
    return intersection(deep_enough, largest_growth * own);
}

// With k in [-1, 1]: the right value, with one corner's own face in place of the opposite one, plus
// Tri((k + 1) / 2) - Tri(k), Tri the trilinear interpolant of the corners.
std::array<double, 7> published_triquadratic_weights(const Vector& k) {
    std::array<double, 7> weights = triquadratic_weights(k);
    const auto add_face = [&](std::size_t face, double weight) {
        weights[face] += 0.5 * weight;
        weights[6] += 0.5 * weight;
    };
    // The corner (x-, y+, z-) is the mean of the faces z-, x- and y-.
    constexpr std::size_t wrong = 2, low_y = 2, high_y = 3;
    const double lagrange = 0.125 * k.x() * (k.x() - 1) * k.y() * (k.y() + 1) * k.z() * (k.z() - 1);
    add_face(low_y, lagrange / 3);
    add_face(high_y, -lagrange / 3);
    const Vector t = 0.5 * (k + Vector::Ones());
    for (std::size_t corner = 0; corner < 8; ++corner) {
        double at_t = 1;
        double at_k = 1;
        for (Axis a = 0; a < 3; ++a) {
            const double sign = (corner >> a & 1) != 0 ? 1 : -1;
            at_t *= 0.5 * (1 + sign * t[a]);
            at_k *= 0.5 * (1 + sign * k[a]);
        }
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t high = corner == wrong ? 0 : corner >> a & 1;
            add_face(2 * a + high, (at_t - at_k) / 3);
        }
    }
    return weights;
}

double limited_length(double own, double sum, const Vector& v, double slope) {
    const double departure = sum - own;
    const double share = admissible_share(own, departure);
    if (share < 1) return own + share * departure;
    const double growth = 1 + slope * Vector(v / own).norm();
    return std::min(sum, growth * own);
}

}  // namespace controlspace
