// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/intersection.h"

#include "metric/decompose.h"
#include "metric/reduction.h"

namespace controlspace {

namespace {

// Relative difference of lengths that rounding may make where the condition is 1; it grows with it.
constexpr double rounding = 1e-14;

// h I against any metric: the principal lengths cut off at h, the frame kept.
Metric cut_off(const Metric& m, double h) {
    EigenFrame frame = eigen_frame(m);
    if (frame.lengths[2] <= h) return m;
    if (frame.lengths[0] >= h) return Metric::isotropic(h);
    for (double& length : frame.lengths) length = std::min(length, h);
    return metric_from_frame(frame.lengths, frame.directions);
}

// C = b^-1 a = U diag(s) V^T. The reduced problem a b^-2 a is C^T C, and working on C itself keeps
// the digits that squaring would lose. The result's square is H H^T with H = a V min(1, 1/s), and
// a v_i / s_i = b u_i, so each column comes from the metric that is the shorter there.
Reduction reduce_plainly(const Metric& a, const Metric& b, const Cholesky& factor) {
    const Svd c = svd(factor.solve(a.matrix()));
    return {c.s, a.matrix() * c.v, b.matrix() * c.u};
}

// The same between the eigenframes, where C is an orthogonal matrix with scaled rows and columns:
// rounding then tilts the frames by 1e-16, as storing the metrics does, and nothing else.
Reduction reduce_between_frames(const Metric& a, const Metric& b) {
    const EigenFrame fa = eigen_frame(a);
    const EigenFrame fb = eigen_frame(b);
    const auto la = Eigen::Map<const Vector>(fa.lengths.data()).asDiagonal();
    const auto lb = Eigen::Map<const Vector>(fb.lengths.data()).asDiagonal();
    const Svd c = svd(lb.inverse() * (fb.directions.transpose() * fa.directions) * la);
    return {c.s, fa.directions * (la * c.v), fb.directions * (lb * c.u)};
}

// The plain way loses the digits of b's condition times C's.
Reduction reduce(const Metric& a, const Metric& b, const Cholesky& factor, double condition_b) {
    const Reduction r = reduce_plainly(a, b, factor);
    return condition_b * r.s[0] > 1e4 * r.s[2] ? reduce_between_frames(a, b) : r;
}

}  // namespace

Reduction reduce(const Metric& a, const Metric& b) {
    const Cholesky factor(b);
    return reduce(a, b, factor, condition(b, factor));
}

Metric intersection_of_tensors(const Metric& a, const Metric& b) {
    if (a == b) return a;
    if (is_isotropic(a)) return cut_off(b, a.xx);
    if (is_isotropic(b)) return cut_off(a, b.xx);

    const Cholesky factor(b);
    const double condition_b = condition(b, factor);
    const Reduction r = reduce(a, b, factor, condition_b);
    if (r.s[0] <= 1 + rounding * condition_b) return a;
    if (r.s[2] >= 1 - rounding * condition_b) return b;
    return left_polar_factor(r.half());
}

double growth(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        return std::max({a.xx / b.xx, a.yy / b.yy, a.zz / b.zz});
    }
    return left_svd(Cholesky(b).solve(a.matrix())).s[0];
}

bool is_within(const Metric& a, double factor, const Metric& b) {
    const double k = factor * (1 + rounding);
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        return a.xx <= k * b.xx && a.yy <= k * b.yy && a.zz <= k * b.zz;
    }
    // Singular values of C = b^-1 a up to k: k² I - C^T C is positive definite. Cheap, and exact
    // enough to say yes, since only the largest singular value counts; no needs a closer look.
    const Cholesky of_b(b);
    const Eigen::Matrix3d c = of_b.solve(a.matrix());
    Metric slack = Metric::from_matrix(-(c.transpose() * c));
    slack.xx += k * k;
    slack.yy += k * k;
    slack.zz += k * k;
    if (slack.xx > 0 && Cholesky(slack).is_positive_definite()) return true;
    const double worst = std::max(condition(a, Cholesky(a)), condition(b, of_b));
    const double longest = factor * (1 + rounding * worst);
    // For no as well, one vector that grows by more is enough: the longest column, turned once
    // more towards the largest singular value.
    int column = 0;
    c.colwise().squaredNorm().maxCoeff(&column);
    const Vector v = c.transpose() * c.col(column);
    const Vector w = c * v;
    constexpr double clearly = 1 + 1e-12;
    if (w.squaredNorm() > clearly * longest * longest * v.squaredNorm()) return false;
    return left_svd(c).s[0] <= longest;
}

}  // namespace controlspace
