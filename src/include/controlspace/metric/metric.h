// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Metric M, the transformation tensor of the paper (§2): symmetric and positive definite; its
/// eigenvalues are the requested edge lengths, in the unit of length of the domain, and its
/// eigenvectors their directions. The Riemannian metric of the meshing literature is M^-2.
///
/// Functions of a metric expect a positive definite one, unless they say otherwise.
struct Metric {
    double xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;

    /// h I: the same length in every direction.
    static constexpr Metric isotropic(double h) { return {h, h, h, 0, 0, 0}; }

    Eigen::Matrix3d matrix() const {
        return (Eigen::Matrix3d() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished();
    }
    /// From the lower triangle of `m`.
    static Metric from_matrix(const Eigen::Matrix3d& m) {
        return {m(0, 0), m(1, 1), m(2, 2), m(1, 0), m(2, 0), m(2, 1)};
    }

    bool operator==(const Metric&) const = default;
};

/// All lengths times `factor`.
inline Metric operator*(double factor, const Metric& m) {
    return {factor * m.xx, factor * m.yy, factor * m.zz,
            factor * m.xy, factor * m.xz, factor * m.yz};
}

/// M^2.
inline Metric square(const Metric& m) {
    return {m.xx * m.xx + m.xy * m.xy + m.xz * m.xz, m.xy * m.xy + m.yy * m.yy + m.yz * m.yz,
            m.xz * m.xz + m.yz * m.yz + m.zz * m.zz, m.xy * (m.xx + m.yy) + m.xz * m.yz,
            m.xz * (m.xx + m.zz) + m.xy * m.yz,      m.yz * (m.yy + m.zz) + m.xy * m.xz};
}

inline bool is_axis_aligned(const Metric& m) { return m.xy == 0 && m.xz == 0 && m.yz == 0; }
inline bool is_isotropic(const Metric& m) {
    return is_axis_aligned(m) && m.xx == m.yy && m.xx == m.zz;
}

/// Whether all numbers are finite and all eigenvalues positive; for any six numbers.
bool is_positive_definite(const Metric& m);

/// Metric with `lengths[i]` along `directions.col(i)`; the columns must be orthonormal.
/// Equal lengths give exactly `Metric::isotropic`, whatever the directions.
Metric metric_from_frame(const std::array<double, 3>& lengths, const Eigen::Matrix3d& directions);

/// Length `across` along the unit vector `normal`, and `along` at right angles to it; exactly
/// `Metric::isotropic` where the two are equal.
inline Metric layer_metric(const Vector& normal, double across, double along) {
    const Vector dn = (across - along) * normal;
    return {along + dn.x() * normal.x(), along + dn.y() * normal.y(), along + dn.z() * normal.z(),
            dn.x() * normal.y(),         dn.x() * normal.z(),         dn.y() * normal.z()};
}

/// Eigen-decomposition of a metric; of any symmetric tensor too, whose "lengths" may be negative.
struct EigenFrame {
    std::array<double, 3> lengths;  ///< ascending
    Eigen::Matrix3d directions;     ///< column i belongs to lengths[i]; orthonormal
};
EigenFrame eigen_frame(const Metric& m);

/// Mean of the three eigenvalues.
inline double mean_length(const Metric& m) { return (m.xx + m.yy + m.zz) / 3; }

/// The general case of `to_metric_space`.
Vector to_metric_space_by_cholesky(const Metric& m, const Vector& v);

/// M^-1 v: the displacement `v` in metric space, where requested edges have length 1.
inline Vector to_metric_space(const Metric& m, const Vector& v) {
    if (is_axis_aligned(m)) return {v.x() / m.xx, v.y() / m.yy, v.z() / m.zz};
    return to_metric_space_by_cholesky(m, v);
}

/// Metric length |M^-1 v|: the length of `v` in units of the requested edge length (paper §2).
inline double metric_length(const Metric& m, const Vector& v) {
    return to_metric_space(m, v).norm();
}

/// Metric lengths of the edges of a box: |M^-1 edges[a] e_a| for the axes a.
std::array<double, 3> metric_edge_lengths(const Metric& m, const Vector& edges);

/// "(xx yy zz xy xz yz)", for messages.
std::string to_string(const Metric& m);

}  // namespace controlspace
