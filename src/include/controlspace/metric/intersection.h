#pragma once

#include <algorithm>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// The general case of `intersection`.
Metric intersection_of_tensors(const Metric& a, const Metric& b);

/// The largest metric that is never longer than `a` or `b` along any direction (paper §2, "min"):
/// simultaneous reduction of the Riemannian metrics, A^1/2 max(1, eig(A^-1/2 B A^-1/2)) A^1/2 with
/// A = a^-2, B = b^-2.
///
/// `a` itself where it lies within `b`, and `b` itself where it lies within `a`, to the bit.
/// Lengths are good to about 1e-15 times the anisotropy (1e-9 at an anisotropy of 1e6), as far as
/// six numbers can hold them. Commutes up to rounding; taken over three or more metrics the result
/// depends on their order.
inline Metric intersection(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        return {std::min(a.xx, b.xx), std::min(a.yy, b.yy), std::min(a.zz, b.zz), 0, 0, 0};
    }
    return intersection_of_tensors(a, b);
}

/// Whether `a` is nowhere longer than `factor * b`, up to rounding: a relative 1e-14 times the
/// larger anisotropy of the two, or 1e-14 where both are axis-aligned.
bool is_within(const Metric& a, double factor, const Metric& b);

/// Least factor k such that `a` is nowhere longer than `k b`: the largest singular value of
/// a b^-1. 1 or less where `a` lies within `b`.
double growth(const Metric& a, const Metric& b);

}  // namespace controlspace
