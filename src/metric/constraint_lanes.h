// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "controlspace/metric/metric.h"
#include "metric/tensor_lanes.h"

namespace controlspace {

/// Constraints are handled four at a time: 256 bits, the vectors that most processors have.
inline constexpr std::size_t constraint_lanes = 4;
using ConstraintLanes = TensorLanesOf<constraint_lanes>;
using ConstraintNumbers = ConstraintLanes::Number;

inline double sum(const ConstraintNumbers& n) { return (n[0] + n[2]) + (n[1] + n[3]); }
inline double trace(const Metric& t) { return t.xx + t.yy + t.zz; }

inline Metric sum(std::span<const ConstraintLanes> tensors) {
    ConstraintLanes total = tensors[0];
    for (const ConstraintLanes& t : tensors.subspan(1)) {
        total.xx += t.xx;
        total.yy += t.yy;
        total.zz += t.zz;
        total.xy += t.xy;
        total.xz += t.xz;
        total.yz += t.yz;
    }
    return {sum(total.xx), sum(total.yy), sum(total.zz),
            sum(total.xy), sum(total.xz), sum(total.yz)};
}

inline ConstraintLanes scaled(const ConstraintLanes& t, double factor) {
    return {factor * t.xx, factor * t.yy, factor * t.zz,
            factor * t.xy, factor * t.xz, factor * t.yz};
}

/// Any 3x3 matrices side by side.
template <int n>
struct MatricesOf {
    LanesOf<n> xx, xy, xz, yx, yy, yz, zx, zy, zz;
};
using Matrices = MatricesOf<constraint_lanes>;

/// S D.
template <class Symmetric>
Matrices product(const ConstraintLanes& s, const Symmetric& d) {
    return {s.xx * d.xx + s.xy * d.xy + s.xz * d.xz, s.xx * d.xy + s.xy * d.yy + s.xz * d.yz,
            s.xx * d.xz + s.xy * d.yz + s.xz * d.zz, s.xy * d.xx + s.yy * d.xy + s.yz * d.xz,
            s.xy * d.xy + s.yy * d.yy + s.yz * d.yz, s.xy * d.xz + s.yy * d.yz + s.yz * d.zz,
            s.xz * d.xx + s.yz * d.xy + s.zz * d.xz, s.xz * d.xy + s.yz * d.yy + s.zz * d.yz,
            s.xz * d.xz + s.yz * d.yz + s.zz * d.zz};
}

/// sym(W L).
inline ConstraintLanes symmetric_product(const Matrices& w, const ConstraintLanes& l) {
    return {
        w.xx * l.xx + w.xy * l.xy + w.xz * l.xz,
        w.yx * l.xy + w.yy * l.yy + w.yz * l.yz,
        w.zx * l.xz + w.zy * l.yz + w.zz * l.zz,
        0.5 * (w.xx * l.xy + w.xy * l.yy + w.xz * l.yz + w.yx * l.xx + w.yy * l.xy + w.yz * l.xz),
        0.5 * (w.xx * l.xz + w.xy * l.yz + w.xz * l.zz + w.zx * l.xx + w.zy * l.xy + w.zz * l.xz),
        0.5 * (w.yx * l.xz + w.yy * l.yz + w.yz * l.zz + w.zx * l.xy + w.zy * l.yy + w.zz * l.yz)};
}

/// Greatest eigenvalue of matrices with real eigenvalues, or a little more. Without their mean m
/// the eigenvalues are the roots of x^3 - 3 p x - q, the greatest is at most 2 sqrt(p), and from
/// there Newton's steps come down to it.
template <int n>
LanesOf<n> greatest_eigenvalues(const MatricesOf<n>& w) {
    using Number = LanesOf<n>;
    constexpr int newton_steps = 3;
    const Number m = (w.xx + w.yy + w.zz) * (1.0 / 3);
    const Number a = w.xx - m;
    const Number b = w.yy - m;
    const Number c = w.zz - m;
    constexpr double rounding = 1e-28;
    constexpr double least = 1e-280;  // against division by 0
    const Number p =
        ((a.square() + b.square() + c.square() + 2 * (w.xy * w.yx + w.xz * w.zx + w.yz * w.zy)) *
         (1.0 / 6))
            .max(rounding * m.square() + least);
    const Number q = a * (b * c - w.yz * w.zy) - w.xy * (w.yx * c - w.yz * w.zx) +
                     w.xz * (w.yx * w.zy - b * w.zx);
    Number x = 2 * p.sqrt();
    for (int i = 0; i < newton_steps; ++i) {
        const Number squared = x.square();
        x = (2 * x * squared + q) / (3 * (squared - p));
    }
    return m + x;
}

/// Lower triangular F with F F^T = I + t D.
struct Triangle {
    double xx, yx, zx, yy, zy, zz;

    Triangle(const Metric& d, double t)
        : xx(std::sqrt(1 + t * d.xx)),
          yx(t * d.xy / xx),
          zx(t * d.xz / xx),
          yy(std::sqrt(1 + t * d.yy - yx * yx)),
          zy((t * d.yz - yx * zx) / yy),
          zz(std::sqrt(1 + t * d.zz - zx * zx - zy * zy)) {}

    Eigen::Matrix3d matrix() const {
        return (Eigen::Matrix3d() << xx, 0, 0, yx, yy, 0, zx, zy, zz).finished();
    }
};

/// F^T T F.
inline ConstraintLanes seen_from(const Triangle& f, const ConstraintLanes& t) {
    const ConstraintNumbers xx = t.xx * f.xx + t.xy * f.yx + t.xz * f.zx;
    const ConstraintNumbers yx = t.xy * f.xx + t.yy * f.yx + t.yz * f.zx;
    const ConstraintNumbers zx = t.xz * f.xx + t.yz * f.yx + t.zz * f.zx;
    const ConstraintNumbers yy = t.yy * f.yy + t.yz * f.zy;
    const ConstraintNumbers zy = t.yz * f.yy + t.zz * f.zy;
    return {f.xx * xx + f.yx * yx + f.zx * zx,
            f.yy * yy + f.zy * zy,
            t.zz * (f.zz * f.zz),
            f.yy * yx + f.zy * zx,
            f.zz * zx,
            f.zz * zy};
}

/// P = (M^-1 H)^T (M^-1 H) for metrics M: H H^T is within M^2 where P <= I.
template <int n>
TensorLanesOf<n> seen_from(const Eigen::Matrix3d& h, const CholeskyLanes<n>& metrics) {
    using Number = LanesOf<n>;
    std::array<VectorLanesOf<n>, 3> k;
    for (int c = 0; c < 3; ++c) {
        k[static_cast<std::size_t>(c)] = metrics.solve(
            {Number::Constant(h(0, c)), Number::Constant(h(1, c)), Number::Constant(h(2, c))});
    }
    const auto dot = [&](std::size_t a, std::size_t b) -> Number {
        return k[a].x * k[b].x + k[a].y * k[b].y + k[a].z * k[b].z;
    };
    return {dot(0, 0), dot(1, 1), dot(2, 2), dot(0, 1), dot(0, 2), dot(1, 2)};
}

/// Upper bounds of the greatest eigenvalues; sharp unless the two greatest are nearly equal.
template <int n>
LanesOf<n> greatest_eigenvalues(const TensorLanesOf<n>& p) {
    return greatest_eigenvalues(
        MatricesOf<n>{p.xx, p.xy, p.xz, p.xy, p.yy, p.yz, p.xz, p.yz, p.zz});
}

}  // namespace controlspace
