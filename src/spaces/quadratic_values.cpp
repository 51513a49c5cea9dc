#include "spaces/quadratic_values.h"

#include <Eigen/Eigenvalues>

#include "metric/blend.h"
#include "metric/decompose.h"
#include "metric/intersection.h"

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
    // The nodes are means of seven metrics, so the sum over 27 nodes is one over seven metrics.
    // On an axis with coordinate s, the functions of the two outer nodes are s(s-1)/2 and s(s+1)/2,
    // and sum to s². With q = s² of the other two axes, the face node of an axis enters by itself
    // (1-q)(1-q'), as half of four edges, q(1-q') + q'(1-q), and as a third of four corners, q q'.
    const Vector q = t.cwiseProduct(t);
    std::array<double, 7> weights{};
    double faces = 0;
    for (Axis a = 0; a < 3; ++a) {
        const double qb = q[(a + 1) % 3];
        const double qc = q[(a + 2) % 3];
        const double plane =
            (1 - qb) * (1 - qc) + 0.5 * (qb * (1 - qc) + qc * (1 - qb)) + qb * qc / 3;
        const auto low = static_cast<std::size_t>(2 * a);
        // A face node is the mean of the neighbour's metric and the leaf's own.
        weights[low] = 0.25 * t[a] * (t[a] - 1) * plane;
        weights[low + 1] = 0.25 * t[a] * (t[a] + 1) * plane;
        faces += weights[low] + weights[low + 1];
    }
    weights[6] = 1 - faces;
    const Metric sum = blend_lengths(
        weights, [&](std::size_t i) -> const Metric& { return i < 6 ? across[i] : own; });

    const Metric departure = difference(sum, own);
    const double share = admissible_share(own, departure);
    const Metric deep_enough = share >= 1 ? sum : moved(own, share, departure);
    if (is_within(deep_enough, largest_growth, own)) return deep_enough;
    const Metric left = difference(deep_enough, own);
    return moved(own, (largest_growth - 1) / largest_departure(own, left), left);
}

}  // namespace controlspace
