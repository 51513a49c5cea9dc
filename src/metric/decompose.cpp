#include "metric/decompose.h"

#include <utility>

#include "metric/jacobi.h"

namespace controlspace {

Svd svd(const Eigen::Matrix3d& matrix) {
    Eigen::Matrix3d b = matrix;
    Eigen::Matrix3d v = Eigen::Matrix3d::Identity();
    std::array<double, 3> squares{b.col(0).squaredNorm(), b.col(1).squaredNorm(),
                                  b.col(2).squaredNorm()};
    // Rotates columns p and q until they are orthogonal; false if they were.
    const auto orthogonalise = [&](int p, int q) {
        constexpr double cosine = 4e-16;  // of columns that rounding alone keeps apart
        double& pp = squares[static_cast<std::size_t>(p)];
        double& qq = squares[static_cast<std::size_t>(q)];
        const double pq = b.col(p).dot(b.col(q));
        if (pq * pq <= cosine * cosine * pp * qq) return false;
        const JacobiRotation rotation(pp, qq, pq);
        rotation.turn(b, p, q);
        rotation.turn(v, p, q);
        pp = b.col(p).squaredNorm();
        qq = b.col(q).squaredNorm();
        return true;
    };
    for (int sweep = 0; sweep < max_jacobi_sweeps; ++sweep) {
        const bool rotated01 = orthogonalise(0, 1);
        const bool rotated02 = orthogonalise(0, 2);
        const bool rotated12 = orthogonalise(1, 2);
        if (!rotated01 && !rotated02 && !rotated12) break;
    }
    std::array<double, 3> s{std::sqrt(squares[0]), std::sqrt(squares[1]), std::sqrt(squares[2])};
    const auto order = [&](int i, int j) {
        double& si = s[static_cast<std::size_t>(i)];
        double& sj = s[static_cast<std::size_t>(j)];
        if (si >= sj) return;
        std::swap(si, sj);
        b.col(i).swap(b.col(j));
        v.col(i).swap(v.col(j));
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    for (int i = 0; i < 3; ++i) b.col(i) /= s[static_cast<std::size_t>(i)];
    return {b, s, v};
}

Metric left_polar_factor(const Eigen::Matrix3d& b) {
    const Svd d = svd(b);
    return metric_from_frame(d.s, d.u);
}

double condition(const Metric& m, const Cholesky& factor) {
    return (m.xx + m.yy + m.zz) * factor.trace_of_inverse() / 9;
}

}  // namespace controlspace
