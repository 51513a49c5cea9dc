#include "metric/intersection.h"

#include <algorithm>

#include "metric/decompose.h"

namespace controlspace {

namespace {

// Singular values this close to 1 mean "equal along this direction".
constexpr double rounding = 1e-14;

// h I against any metric: the principal lengths cut off at h, the frame kept.
Metric cut_off(const Metric& m, double h) {
    EigenFrame frame = eigen_frame(m);
    if (frame.lengths[2] <= h) return m;
    if (frame.lengths[0] >= h) return Metric::isotropic(h);
    for (double& length : frame.lengths) length = std::min(length, h);
    return metric_from_frame(frame.lengths, frame.directions);
}

}  // namespace

Metric intersection(const Metric& a, const Metric& b) {
    const bool a_aligned = is_axis_aligned(a);
    const bool b_aligned = is_axis_aligned(b);
    if (a_aligned && b_aligned) {
        return {std::min(a.xx, b.xx), std::min(a.yy, b.yy), std::min(a.zz, b.zz), 0, 0, 0};
    }
    if (a_aligned && is_isotropic(a)) return cut_off(b, a.xx);
    if (b_aligned && is_isotropic(b)) return cut_off(a, b.xx);

    // With C = b^-1 a, the reduced problem a b^-2 a is C^T C: its eigenvalues are the squares of
    // C's singular values, and working on C itself keeps the digits that squaring would lose.
    // The result's square is B B^T, B = a V min(1, 1/s); where s > 1, a v / s = b u is the more
    // accurate of the two.
    const Svd c = svd(Cholesky(b).solve(a.matrix()));
    if (c.s[0] <= 1 + rounding) return a;
    if (c.s[2] >= 1 - rounding) return b;
    Eigen::Matrix3d half;
    for (int i = 0; i < 3; ++i) {
        half.col(i) = c.s[static_cast<std::size_t>(i)] <= 1 ? a.matrix() * c.v.col(i)
                                                             : b.matrix() * c.u.col(i);
    }
    return left_polar_factor(half);
}

double growth(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        return std::max({a.xx / b.xx, a.yy / b.yy, a.zz / b.zz});
    }
    return svd(Cholesky(b).solve(a.matrix())).s[0];
}

bool is_within(const Metric& a, double factor, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        const double f = factor * (1 + rounding);
        return a.xx <= f * b.xx && a.yy <= f * b.yy && a.zz <= f * b.zz;
    }
    return growth(a, b) <= factor * (1 + rounding);
}

}  // namespace controlspace
