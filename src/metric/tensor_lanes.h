// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// One number of each of `n` things, for computing with all of them at once. Unaligned, so that
/// vectors of lanes are allocated as everything else is.
template <int n>
using LanesOf = Eigen::Array<double, n, 1, Eigen::DontAlign>;

inline constexpr int lane_count = 8;
using Lanes = LanesOf<lane_count>;

/// Symmetric tensors side by side.
template <int n>
struct TensorLanesOf {
    using Number = LanesOf<n>;
    Number xx = Number::Ones(), yy = xx, zz = xx, xy = Number::Zero(), xz = xy, yz = xy;

    Metric operator[](Eigen::Index lane) const {
        return {xx[lane], yy[lane], zz[lane], xy[lane], xz[lane], yz[lane]};
    }
    void set(Eigen::Index lane, const Metric& m) {
        xx[lane] = m.xx;
        yy[lane] = m.yy;
        zz[lane] = m.zz;
        xy[lane] = m.xy;
        xz[lane] = m.xz;
        yz[lane] = m.yz;
    }
};
using TensorLanes = TensorLanesOf<lane_count>;

/// Vectors side by side.
template <int n>
struct VectorLanesOf {
    LanesOf<n> x = LanesOf<n>::Zero(), y = x, z = x;

    Vector operator[](Eigen::Index lane) const { return {x[lane], y[lane], z[lane]}; }
    void set(Eigen::Index lane, const Vector& v) {
        x[lane] = v.x();
        y[lane] = v.y();
        z[lane] = v.z();
    }
    LanesOf<n> distances(const Point& p) const {
        return ((x - p.x()).square() + (y - p.y()).square() + (z - p.z()).square()).sqrt();
    }
};
using VectorLanes = VectorLanesOf<lane_count>;

/// From `v` to `p`.
inline VectorLanes displacements(const VectorLanes& v, const Point& p) {
    return {p.x() - v.x, p.y() - v.y, p.z() - v.z};
}

/// M^2.
inline TensorLanes square(const TensorLanes& m) {
    return {m.xx.square() + m.xy.square() + m.xz.square(),
            m.xy.square() + m.yy.square() + m.yz.square(),
            m.xz.square() + m.yz.square() + m.zz.square(),
            m.xy * (m.xx + m.yy) + m.xz * m.yz,
            m.xz * (m.xx + m.zz) + m.xy * m.yz,
            m.yz * (m.yy + m.zz) + m.xy * m.xz};
}

/// |M v|.
inline Lanes lengths_of_products(const TensorLanes& m, const VectorLanes& v) {
    return ((m.xx * v.x + m.xy * v.y + m.xz * v.z).square() +
            (m.xy * v.x + m.yy * v.y + m.yz * v.z).square() +
            (m.xz * v.x + m.yz * v.y + m.zz * v.z).square())
        .sqrt();
}

/// As `Cholesky`, to the bit.
template <int n>
class CholeskyLanes {
public:
    using Number = LanesOf<n>;

    explicit CholeskyLanes(const TensorLanesOf<n>& m)
        : i0_(m.xx.inverse()), l10_(m.xy * i0_), l20_(m.xz * i0_) {
        i1_ = (m.yy - l10_ * m.xy).inverse();
        const Number left = m.yz - l20_ * m.xy;
        l21_ = left * i1_;
        i2_ = (m.zz - l20_ * m.xz - l21_ * left).inverse();
    }
    VectorLanesOf<n> solve(const VectorLanesOf<n>& v) const {
        const Number y = v.y - l10_ * v.x;
        const Number z = (v.z - l20_ * v.x - l21_ * y) * i2_;
        const Number b = y * i1_ - l21_ * z;
        return {v.x * i0_ - l10_ * b - l20_ * z, b, z};
    }
    Number trace_of_inverse() const {
        const Number l = l10_ * l21_ - l20_;
        return i0_ + i1_ * (1 + l10_.square()) + i2_ * (1 + l21_.square() + l.square());
    }
    TensorLanesOf<n> inverse() const {
        const Number l = l10_ * l21_ - l20_;
        const Number xz = l * i2_;
        const Number yz = -l21_ * i2_;
        return {i0_ + l10_.square() * i1_ + l * xz,
                i1_ - l21_ * yz,
                i2_,
                -l10_ * i1_ - l21_ * xz,
                xz,
                yz};
    }
    /// Positive where the tensor is positive definite.
    Number least_pivot() const { return i0_.min(i1_).min(i2_); }
    Number determinant() const { return (i0_ * i1_ * i2_).inverse(); }

private:
    Number i0_, l10_, l20_, i1_, l21_, i2_;
};

/// |M^-1 v|, M positive definite: to the bit what `metric_length` gives, but for axis-aligned M.
inline Lanes metric_lengths(const TensorLanes& m, const VectorLanes& v) {
    const auto [x, y, z] = CholeskyLanes<lane_count>(m).solve(v);
    return ((x.square() + y.square()) + z.square()).sqrt();
}

/// Pivots of a factorisation: the tensor is positive definite where all three are positive.
struct Pivots {
    Lanes xx, yy, zz;

    bool are_positive(Eigen::Index lane) const {
        return (int{xx[lane] > 0} & int{yy[lane] > 0} & int{zz[lane] > 0}) != 0;
    }
};

/// Of `b_factor` * b2 - a2, made less by what rounding leaves in doubt. The factorisation's
/// backward error is a few epsilon of the largest entry, which the diagonal gives up in advance.
inline Pivots room_below(const Metric& a2, const Lanes& b_factor, const TensorLanes& b2) {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    const Lanes doubt = rounding * b_factor * (b2.xx + b2.yy + b2.zz);
    const Lanes xx = b_factor * b2.xx - a2.xx - doubt;
    const Lanes xy = b_factor * b2.xy - a2.xy;
    const Lanes xz = b_factor * b2.xz - a2.xz;
    const Lanes yx = xy / xx;
    const Lanes zx = xz / xx;
    const Lanes yy = b_factor * b2.yy - a2.yy - doubt - yx * xy;
    const Lanes yz = b_factor * b2.yz - a2.yz - zx * xy;
    const Lanes zz = b_factor * b2.zz - a2.zz - doubt - zx * xz - yz.square() / yy;
    return {xx, yy, zz};
}

/// The least of three numbers that are all positive where the tensor is positive definite, and not
/// all where it is not.
template <int n>
LanesOf<n> least_minor(const TensorLanesOf<n>& t) {
    const LanesOf<n> xy = t.xx * t.yy - t.xy.square();
    const LanesOf<n> determinant =
        t.zz * xy - t.xx * t.yz.square() - t.yy * t.xz.square() + 2 * t.xy * t.xz * t.yz;
    return t.xx.min(xy).min(determinant);
}
/// The same of most I - T.
template <int n>
LanesOf<n> least_minor(const LanesOf<n>& most, const TensorLanesOf<n>& t) {
    return least_minor(
        TensorLanesOf<n>{most - t.xx, most - t.yy, most - t.zz, -t.xy, -t.xz, -t.yz});
}

}  // namespace controlspace
