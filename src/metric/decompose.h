// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Singular value decomposition B = U diag(s) V^T of a regular 3x3 matrix, s descending.
struct Svd {
    Eigen::Matrix3d u;
    std::array<double, 3> s;
    Eigen::Matrix3d v;
};

/// By one-sided Jacobi rotations (Hestenes): small singular values keep their relative accuracy
/// when the columns of B are of very different size, and equal ones need no special case.
Svd svd(const Eigen::Matrix3d& b);

/// The same without V.
struct LeftSvd {
    Eigen::Matrix3d u;
    std::array<double, 3> s;
};
LeftSvd left_svd(const Eigen::Matrix3d& b);

/// U diag(s) U^T for B = U diag(s) V^T, that is (B B^T)^1/2.
Metric left_polar_factor(const Eigen::Matrix3d& b);

/// Cholesky factorisation M = L D L^T, kept as the three reciprocal pivots and L's lower triangle.
/// Backward stable for the metrics that the structures hold, where inverting by cofactors is not:
/// it loses all digits at an anisotropy of 1e6.
class Cholesky {
public:
    explicit Cholesky(const Metric& m) : i0_(1 / m.xx), l10_(m.xy * i0_), l20_(m.xz * i0_) {
        i1_ = 1 / (m.yy - l10_ * m.xy);
        const double yz = m.yz - l20_ * m.xy;
        l21_ = yz * i1_;
        i2_ = 1 / (m.zz - l20_ * m.xz - l21_ * yz);
    }
    bool is_positive_definite() const {
        return i0_ > 0 && i1_ > 0 && i2_ > 0 && std::isfinite(i0_ + i1_ + i2_);
    }

    /// M^-1 v.
    Vector solve(const Vector& v) const {
        const double y = v.y() - l10_ * v.x();
        const double z = (v.z() - l20_ * v.x() - l21_ * y) * i2_;
        const double b = y * i1_ - l21_ * z;
        return {v.x() * i0_ - l10_ * b - l20_ * z, b, z};
    }
    /// M^-1 B, column by column.
    Eigen::Matrix3d solve(const Eigen::Matrix3d& b) const {
        Eigen::Matrix3d x;
        for (int c = 0; c < 3; ++c) x.col(c) = solve(Vector(b.col(c)));
        return x;
    }
    double trace_of_inverse() const {
        const double l = l10_ * l21_ - l20_;
        return i0_ + i1_ * (1 + l10_ * l10_) + i2_ * (1 + l21_ * l21_ + l * l);
    }

private:
    double i0_, l10_, l20_, i1_, l21_, i2_;
};

/// Anisotropy of `m`, the ratio of its largest to its smallest eigenvalue, or down to a ninth of
/// it; 1 for isotropic ones. `factor` must be the factorisation of `m`.
/// The six numbers of a metric fix the lengths along its directions to a relative
/// `condition * 1e-16` only: no algorithm gives more.
double condition(const Metric& m, const Cholesky& factor);

/// Whether factor * b2 - a2 is positive definite beyond doubt, as in `room_below`.
bool is_below(const Metric& a2, double factor, const Metric& b2);

}  // namespace controlspace
