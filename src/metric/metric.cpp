// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/metric.h"

#include <fmt/format.h>

#include "metric/decompose.h"

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
