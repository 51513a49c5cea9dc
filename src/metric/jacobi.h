#pragma once

#include <cmath>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Plane rotation that makes the symmetric 2x2 matrix (pp pq; pq qq) diagonal: the smaller of the
/// two angles. Afterwards pp is less by `tangent * pq`, and qq more.
struct JacobiRotation {
    double cosine, sine, tangent;

    /// `pq` must not be 0.
    JacobiRotation(double pp, double qq, double pq) {
        const double d = qq - pp;
        tangent = 2 * pq / (d + std::copysign(std::sqrt(d * d + 4 * pq * pq), d));
        cosine = 1 / std::sqrt(1 + tangent * tangent);
        sine = cosine * tangent;
    }

    /// Turns columns p and q of `m`.
    void turn(Eigen::Matrix3d& m, int p, int q) const {
        const Vector old = m.col(p);
        m.col(p) = cosine * old - sine * m.col(q);
        m.col(q) = sine * old + cosine * m.col(q);
    }
};

/// Jacobi's methods converge quadratically: four or five sweeps are usual.
inline constexpr int max_jacobi_sweeps = 30;

}  // namespace controlspace
