// SPDX-License-Identifier: Apache-2.0
#include "metric/decompose.h"

#include <limits>
#include <utility>

namespace controlspace {

namespace {

// Plane rotation that makes the symmetric 2x2 matrix (pp pq; pq qq) diagonal: the smaller of the
// two angles. Afterwards pp is less by `tangent * pq`, and qq more.
struct JacobiRotation {
    double cosine, sine, tangent;

    // `pq` must not be 0.
    JacobiRotation(double pp, double qq, double pq) {
        const double d = qq - pp;
        tangent = 2 * pq / (d + std::copysign(std::sqrt(d * d + 4 * pq * pq), d));
        cosine = 1 / std::sqrt(1 + tangent * tangent);
        sine = cosine * tangent;
    }

    // Rotates columns p and q of `m`.
    void apply(Eigen::Matrix3d& m, int p, int q) const {
        const Vector old = m.col(p);
        m.col(p) = cosine * old - sine * m.col(q);
        m.col(q) = sine * old + cosine * m.col(q);
    }
};

// Calls rotate(p, q) for all pairs of axes until a sweep changes nothing: until all calls return
// false. Jacobi's methods converge quadratically: four or five sweeps are usual.
template <class Rotate>
void sweep(Rotate&& rotate) {
    constexpr int most_sweeps = 30;
    for (int i = 0; i < most_sweeps; ++i) {
        const bool rotated01 = rotate(0, 1);
        const bool rotated02 = rotate(0, 2);
        const bool rotated12 = rotate(1, 2);
        if (!rotated01 && !rotated02 && !rotated12) return;
    }
}

// Sorts three things by calling sort_pair(i, j) for their indices i < j.
template <class SortPair>
void sort_three(SortPair&& sort_pair) {
    sort_pair(0, 1);
    sort_pair(1, 2);
    sort_pair(0, 1);
}

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

EigenFrame eigen_frame(const Metric& m) {
    // Two-sided Jacobi: on positive definite tensors it is as accurate as the six numbers are.
    EigenFrame frame{{m.xx, m.yy, m.zz}, Eigen::Matrix3d::Identity()};
    auto& [diagonal, v] = frame;
    // Entry (p, q) has the index of the third axis.
    std::array<double, 3> opposite{m.yz, m.xz, m.xy};
    const auto annihilate = [&](int p, int q) {
        constexpr double negligible = 1e-16;
        double& pp = diagonal[index(p)];
        double& qq = diagonal[index(q)];
        double& pq = opposite[index(3 - p - q)];
        if (pq * pq <= negligible * negligible * std::abs(pp * qq)) return false;
        const JacobiRotation rotation(pp, qq, pq);
        pp -= rotation.tangent * pq;
        qq += rotation.tangent * pq;
        pq = 0;
        double& kp = opposite[index(q)];
        double& kq = opposite[index(p)];
        const double old = kp;
        kp = rotation.cosine * old - rotation.sine * kq;
        kq = rotation.sine * old + rotation.cosine * kq;
        rotation.apply(v, p, q);
        return true;
    };
    sweep(annihilate);
    sort_three([&](int i, int j) {
        if (!(diagonal[index(i)] > diagonal[index(j)])) return;
        std::swap(diagonal[index(i)], diagonal[index(j)]);
        v.col(i).swap(v.col(j));
    });
    return frame;
}

namespace {

// `v`, if given, is rotated as the columns of the matrix are: the identity becomes V.
template <class... V>
LeftSvd jacobi_svd(const Eigen::Matrix3d& matrix, V&... v) {
    LeftSvd d{matrix, {}};
    auto& [b, s] = d;
    for (int i = 0; i < 3; ++i) s[index(i)] = b.col(i).squaredNorm();
    // Rotates columns p and q until they are orthogonal; false if they were.
    const auto orthogonalise = [&](int p, int q) {
        constexpr double cosine = 4e-16;  // of columns that rounding alone keeps apart
        double& pp = s[index(p)];
        double& qq = s[index(q)];
        const double pq = b.col(p).dot(b.col(q));
        if (pq * pq <= cosine * cosine * pp * qq) return false;
        const JacobiRotation rotation(pp, qq, pq);
        rotation.apply(b, p, q);
        (rotation.apply(v, p, q), ...);
        pp = b.col(p).squaredNorm();
        qq = b.col(q).squaredNorm();
        return true;
    };
    sweep(orthogonalise);
    for (double& length : s) length = std::sqrt(length);
    sort_three([&](int i, int j) {
        if (s[index(i)] >= s[index(j)]) return;
        std::swap(s[index(i)], s[index(j)]);
        b.col(i).swap(b.col(j));
        (v.col(i).swap(v.col(j)), ...);
    });
    for (int i = 0; i < 3; ++i) b.col(i) /= s[index(i)];
    return d;
}

}  // namespace

Svd svd(const Eigen::Matrix3d& b) {
    Eigen::Matrix3d v = Eigen::Matrix3d::Identity();
    const auto [u, s] = jacobi_svd(b, v);
    return {u, s, v};
}

LeftSvd left_svd(const Eigen::Matrix3d& b) { return jacobi_svd(b); }

Metric left_polar_factor(const Eigen::Matrix3d& b) {
    const auto [u, s] = left_svd(b);
    return metric_from_frame(s, u);
}

double condition(const Metric& m, const Cholesky& factor) {
    return (m.xx + m.yy + m.zz) * factor.trace_of_inverse() / 9;
}

bool is_below(const Metric& a2, double factor, const Metric& b2) {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    const double doubt = rounding * factor * (b2.xx + b2.yy + b2.zz);
    const double xx = factor * b2.xx - a2.xx - doubt;
    const double yy = factor * b2.yy - a2.yy - doubt;
    const double zz = factor * b2.zz - a2.zz - doubt;
    if (!(xx > 0 && yy > 0 && zz > 0)) return false;
    return Cholesky(
               {xx, yy, zz, factor * b2.xy - a2.xy, factor * b2.xz - a2.xz, factor * b2.yz - a2.yz})
        .is_positive_definite();
}

}  // namespace controlspace
