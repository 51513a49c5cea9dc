#include "metric/decompose.h"

#include <utility>

namespace controlspace {

namespace {

// Rotates columns p and q of `b` (and of `v` along) until they are orthogonal; false if they were.
bool orthogonalise(Eigen::Matrix3d& b, Eigen::Matrix3d& v, int p, int q) {
    constexpr double orthogonal = 4e-16;  // cosine of columns that rounding alone keeps apart
    const double pp = b.col(p).squaredNorm();
    const double qq = b.col(q).squaredNorm();
    const double pq = b.col(p).dot(b.col(q));
    if (std::abs(pq) <= orthogonal * std::sqrt(pp * qq)) return false;
    const double zeta = (qq - pp) / (2 * pq);
    const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
    const double c = 1 / std::sqrt(1 + t * t);
    const double s = c * t;
    for (Eigen::Matrix3d* m : {&b, &v}) {
        const Vector old = m->col(p);
        m->col(p) = c * old - s * m->col(q);
        m->col(q) = s * old + c * m->col(q);
    }
    return true;
}

}  // namespace

Svd svd(const Eigen::Matrix3d& matrix) {
    Eigen::Matrix3d b = matrix;
    Eigen::Matrix3d v = Eigen::Matrix3d::Identity();
    constexpr int max_sweeps = 30;  // converges quadratically: four or five are usual
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
        const bool rotated01 = orthogonalise(b, v, 0, 1);
        const bool rotated02 = orthogonalise(b, v, 0, 2);
        const bool rotated12 = orthogonalise(b, v, 1, 2);
        if (!rotated01 && !rotated02 && !rotated12) break;
    }
    std::array<double, 3> s{b.col(0).norm(), b.col(1).norm(), b.col(2).norm()};
    const auto order = [&](int i, int j) {
        if (s[i] >= s[j]) return;
        std::swap(s[i], s[j]);
        b.col(i).swap(b.col(j));
        v.col(i).swap(v.col(j));
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    for (int i = 0; i < 3; ++i) b.col(i) /= s[i];
    return {b, s, v};
}

Metric left_polar_factor(const Eigen::Matrix3d& b) {
    const Svd d = svd(b);
    return metric_from_frame(d.s, d.u);
}

}  // namespace controlspace
