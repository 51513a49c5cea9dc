// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/nonconformity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "controlspace/metric/intersection.h"
#include "metric/decompose.h"

namespace controlspace {

namespace {

// k + 1/k - 2, without the cancellation near k = 1.
double excess(double k) { return (k - 1) * (k - 1) / k; }

double norm_of_excess(double x, double y, double z) {
    return std::sqrt(excess(x) * excess(x) + excess(y) * excess(y) + excess(z) * excess(z));
}

}  // namespace

double nonconformity(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        return norm_of_excess(a.xx / b.xx, a.yy / b.yy, a.zz / b.zz);
    }
    return (Cholesky(a).solve(b.matrix()) + Cholesky(b).solve(a.matrix()) -
            2 * Eigen::Matrix3d::Identity())
        .norm();
}

double largest_ratio(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) return std::max(growth(a, b), growth(b, a));
    const Eigen::Matrix3d seen = Cholesky(b).solve(a.matrix());
    // In closed form, to round-off of the greatest.
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squared;
    squared.computeDirect(seen.transpose() * seen, Eigen::EigenvaluesOnly);
    const double least = squared.eigenvalues()[0], greatest = squared.eigenvalues()[2];
    constexpr double most_far_apart = 1e4;
    if (least > 0 && greatest < most_far_apart * least) {
        return std::sqrt(std::max(greatest, 1 / least));
    }
    const auto ratios = left_svd(seen).s;
    return std::max(ratios[0], 1 / ratios[2]);
}

double directional_nonconformity(const Metric& a, const Metric& b) {
    const double delta = nonconformity(a, b);
    if (is_axis_aligned(a) && is_axis_aligned(b)) return delta;
    return std::max(delta, excess(largest_ratio(a, b)));
}

double nonconformity_of_factor(double k) { return std::sqrt(3.0) * excess(k); }

double nonconformity_along(double k) { return excess(k); }

double largest_factor_within(double delta) {
    const double excess_of_each = delta / std::sqrt(3.0);
    return 1 + 0.5 * (excess_of_each + std::sqrt(excess_of_each * (excess_of_each + 4)));
}

double largest_factor_along(double delta) { return largest_factor_within(std::sqrt(3.0) * delta); }

double riemannian_nonconformity(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        const auto square = [](double k) { return k * k; };
        return norm_of_excess(square(a.xx / b.xx), square(a.yy / b.yy), square(a.zz / b.zz));
    }
    const Cholesky fa(a);
    const Cholesky fb(b);
    // Both terms transposed, which leaves the norm as it is: (a a b^-1 b^-1)^T = b^-1 b^-1 a a.
    const Eigen::Matrix3d ab = fb.solve(fb.solve(Eigen::Matrix3d(a.matrix() * a.matrix())));
    const Eigen::Matrix3d ba = fa.solve(fa.solve(Eigen::Matrix3d(b.matrix() * b.matrix())));
    return (ab + ba - 2 * Eigen::Matrix3d::Identity()).norm();
}

}  // namespace controlspace
