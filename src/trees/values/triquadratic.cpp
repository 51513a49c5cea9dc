#include "trees/values/triquadratic.h"

#include <Eigen/Eigenvalues>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"
#include "metric/decompose.h"

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

// The largest length along any direction that `departure` adds to `own`, in those of `own`. It
// bounds growth(own + s departure, own) by 1 + s times it.
double largest_departure(const Metric& own, const Metric& departure) {
    if (is_axis_aligned(own) && is_axis_aligned(departure)) {
        return std::max({departure.xx / own.xx, departure.yy / own.yy, departure.zz / own.zz});
    }
    return svd(Cholesky(own).solve(departure.matrix())).s[0];
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
    if (is_within(deep_enough, largest_growth, own)) return deep_enough;
    const Metric left = difference(deep_enough, own);
    return moved(own, (largest_growth - 1) / largest_departure(own, left), left);
}

double limited_length(double own, double sum, const Vector& v, double slope) {
    const double departure = sum - own;
    const double share = admissible_share(own, departure);
    if (share < 1) return own + share * departure;
    const double growth = 1 + slope * Vector(v / own).norm();
    if (is_within(Metric::isotropic(sum), growth, Metric::isotropic(own))) return sum;
    return own + (growth - 1) / (departure / own) * departure;
}

}  // namespace controlspace
