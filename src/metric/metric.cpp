#include "controlspace/metric/metric.h"

#include <fmt/format.h>

#include <utility>

#include "metric/decompose.h"
#include "metric/jacobi.h"

namespace controlspace {

bool is_positive_definite(const Metric& m) {
    const double sum = m.xx + m.yy + m.zz + m.xy + m.xz + m.yz;
    return std::isfinite(sum) && m.xx > 0 && Cholesky(m).is_positive_definite();
}

Metric metric_from_frame(const std::array<double, 3>& lengths, const Eigen::Matrix3d& directions) {
    if (lengths[0] == lengths[1] && lengths[0] == lengths[2]) return Metric::isotropic(lengths[0]);
    Metric m{0, 0, 0, 0, 0, 0};
    for (int i = 0; i < 3; ++i) {
        const Vector e = directions.col(i);
        const Vector he = lengths[static_cast<std::size_t>(i)] * e;
        m.xx += he.x() * e.x();
        m.yy += he.y() * e.y();
        m.zz += he.z() * e.z();
        m.xy += he.x() * e.y();
        m.xz += he.x() * e.z();
        m.yz += he.y() * e.z();
    }
    return m;
}

EigenFrame eigen_frame(const Metric& m) {
    // Two-sided Jacobi: on positive definite tensors it is as accurate as the six numbers are.
    std::array<double, 3> diagonal{m.xx, m.yy, m.zz};
    std::array<double, 3> opposite{m.yz, m.xz,
                                   m.xy};  // the entry that is in neither row nor column
    Eigen::Matrix3d v = Eigen::Matrix3d::Identity();
    // Zeroes entry (p, q); k is the third axis. False if it was negligible.
    const auto annihilate = [&](std::size_t p, std::size_t q, std::size_t k) {
        constexpr double negligible = 1e-16;
        const double pq = opposite[k];
        if (pq * pq <= negligible * negligible * std::abs(diagonal[p] * diagonal[q])) return false;
        const JacobiRotation rotation(diagonal[p], diagonal[q], pq);
        diagonal[p] -= rotation.tangent * pq;
        diagonal[q] += rotation.tangent * pq;
        opposite[k] = 0;
        const double kp = opposite[q];
        opposite[q] = rotation.cosine * kp - rotation.sine * opposite[p];
        opposite[p] = rotation.sine * kp + rotation.cosine * opposite[p];
        rotation.turn(v, static_cast<int>(p), static_cast<int>(q));
        return true;
    };
    for (int sweep = 0; sweep < max_jacobi_sweeps; ++sweep) {
        const bool rotated01 = annihilate(0, 1, 2);
        const bool rotated02 = annihilate(0, 2, 1);
        const bool rotated12 = annihilate(1, 2, 0);
        if (!rotated01 && !rotated02 && !rotated12) break;
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    const auto ascend = [&](std::size_t i, std::size_t j) {
        if (diagonal[order[i]] > diagonal[order[j]]) std::swap(order[i], order[j]);
    };
    ascend(0, 1);
    ascend(1, 2);
    ascend(0, 1);
    EigenFrame frame;
    for (std::size_t i = 0; i < 3; ++i) {
        frame.lengths[i] = diagonal[order[i]];
        frame.directions.col(static_cast<int>(i)) = v.col(static_cast<int>(order[i]));
    }
    return frame;
}

Vector to_metric_space_by_cholesky(const Metric& m, const Vector& v) {
    return Cholesky(m).solve(v);
}

std::array<double, 3> metric_edge_lengths(const Metric& m, const Vector& edges) {
    if (is_axis_aligned(m)) return {edges.x() / m.xx, edges.y() / m.yy, edges.z() / m.zz};
    const Cholesky factor(m);
    std::array<double, 3> lengths{};
    for (Axis a = 0; a < 3; ++a) {
        lengths[static_cast<std::size_t>(a)] =
            factor.solve(Vector(edges[a] * Vector::Unit(a))).norm();
    }
    return lengths;
}

std::string to_string(const Metric& m) {
    return fmt::format("({} {} {} {} {} {})", m.xx, m.yy, m.zz, m.xy, m.xz, m.yz);
}

}  // namespace controlspace
