// SPDX-License-Identifier: Apache-2.0
#include "metric/running_intersection.h"

#include <Eigen/Geometry>
#include <cmath>

#include "controlspace/metric/intersection.h"
#include "metric/decompose.h"

namespace controlspace {

// With C = m^-1 H, the eigenvalues of E = C^T C - I tell by how much the metric's square exceeds
// that of m. If one alone is positive, l with direction v, the intersection has the factor
//     H (I - (1 - 1 / sqrt(1 + l)) v v^T),
// which spares the singular value decompositions of `intersection`: H need not be symmetric until
// somebody asks for the metric. The other eigenvalues lie l away from l, or more, so v is good to
// rounding / l, and its error, which comes in times l, is rounding again.

namespace {

// C^T C has lost the digits of C's condition; where that counts, `intersection` goes other ways.
constexpr double largest_trace = 64;
constexpr double largest_condition = 1e4;  // of C, times that of m, as in intersection.cpp
constexpr double rounding = 2e-14;         // of lengths squared, where the condition is 1

// Invariants of a symmetric tensor: its characteristic polynomial is l^3 - i1 l^2 + i2 l - i3.
struct Invariants {
    double i1, i2, i3;

    explicit Invariants(const Eigen::Matrix3d& e)
        : i1(e.trace()),
          i2(e(0, 0) * e(1, 1) - e(1, 0) * e(1, 0) + e(0, 0) * e(2, 2) - e(2, 0) * e(2, 0) +
             e(1, 1) * e(2, 2) - e(2, 1) * e(2, 1)),
          i3(e.determinant()) {}

    // Descartes: all three roots being real, as many are positive as the coefficients change sign.
    bool have_one_positive_root() const { return i3 > 0 && !(i1 > 0 && i2 > 0); }

    // Beyond it the polynomial is convex and rises, so Newton's steps come down to it.
    double positive_root() const {
        double l = i1 <= 0 && i2 > 0 ? i3 / i2 : std::sqrt(i1 * i1 - 2 * i2);
        for (;;) {
            const double value = ((l - i1) * l + i2) * l - i3;
            const double slope = (3 * l - 2 * i1) * l + i2;
            const double next = l - value / slope;
            if (!(next < l)) return l;
            l = next;
        }
    }
};

// Unit vector that the singular symmetric tensor `e`, of rank 2, maps to zero.
Vector kernel(const Eigen::Matrix3d& e) {
    const Vector x = e.col(0);
    const Vector y = e.col(1);
    const Vector z = e.col(2);
    Vector longest = x.cross(y);
    for (const Vector& other : {Vector(y.cross(z)), Vector(z.cross(x))}) {
        if (other.squaredNorm() > longest.squaredNorm()) longest = other;
    }
    return longest / longest.norm();
}

}  // namespace

RunningIntersection::RunningIntersection(const Metric& m)
    : factor_(m.matrix()),
      square_(controlspace::square(m)),
      longest_(eigen_frame(m).lengths[2]),
      metric_(m) {}

Metric RunningIntersection::metric() const {
    return is_factored_ ? left_polar_factor(factor_) : metric_;
}

bool RunningIntersection::shorten_to(const Metric& m) {
    const Cholesky of_m(m);
    const double condition_m = condition(m, of_m);
    const Eigen::Matrix3d c = of_m.solve(factor_);
    Eigen::Matrix3d e = c.transpose() * c;
    const double trace = e.trace();
    e.diagonal().array() -= 1;
    const Invariants of_e(e);
    // Of C: its condition squared is at most trace^3 / determinant squared.
    const double determinant = 1 + of_e.i1 + of_e.i2 + of_e.i3;
    const double allowed = largest_condition / condition_m;
    if (!of_e.have_one_positive_root() || trace > largest_trace ||
        trace * trace * trace > allowed * allowed * determinant) {
        return shorten_in_general(m);
    }
    const double l = of_e.positive_root();
    if (l <= rounding * condition_m) return false;
    e.diagonal().array() -= l;
    const Vector v = kernel(e);
    is_factored_ = true;
    update(factor_ - (1 - 1 / std::sqrt(1 + l)) * (factor_ * v) * v.transpose());
    return true;
}

bool RunningIntersection::shorten_in_general(const Metric& m) {
    const Metric before = metric();
    const Metric after = intersection(before, m);
    if (after == before) return false;
    metric_ = after;
    is_factored_ = false;
    update(metric_.matrix());
    return true;
}

void RunningIntersection::update(const Eigen::Matrix3d& factor) {
    factor_ = factor;
    square_ = Metric::from_matrix(factor * factor.transpose());
    constexpr unsigned now_and_then = 8;
    if (++changes_ % now_and_then == 0) longest_ = std::sqrt(eigen_frame(square_).lengths[2]);
}

}  // namespace controlspace
