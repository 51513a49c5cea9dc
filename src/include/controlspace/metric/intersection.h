// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// How three metrics or more are intersected; of two there is one intersection.
enum class IntersectionRule {
    order_free,  ///< the largest metric within all of them (`order_free_intersection`)
    /// As published: one after the other, which depends on their order. Cones are taken by their
    /// smallest length.
    in_turn,
};

/// The general case of `intersection`.
Metric intersection_of_tensors(const Metric& a, const Metric& b);

/// Intersection of two metrics (paper §2, "min"): the largest metric that is not longer than `a` or
/// `b` in any direction. By simultaneous reduction of the Riemannian metrics A = a^-2, B = b^-2:
/// A^1/2 max(1, eig(A^-1/2 B A^-1/2)) A^1/2.
///
/// Returns `a` itself if it is within `b`, and `b` itself if it is within `a`, to the bit. Lengths
/// are accurate to about 1e-15 times the anisotropy (1e-9 at an anisotropy of 1e6), the accuracy of
/// six numbers. Commutes up to rounding; over three or more metrics the result depends on the
/// order.
inline Metric intersection(const Metric& a, const Metric& b) {
    if (is_axis_aligned(a) && is_axis_aligned(b)) {
        return {std::min(a.xx, b.xx), std::min(a.yy, b.yy), std::min(a.zz, b.zz), 0, 0, 0};
    }
    return intersection_of_tensors(a, b);
}

/// Whether `a` is not longer than `factor * b` in any direction, up to a relative 1e-14 times the
/// larger anisotropy of the two, or 1e-14 if both are axis-aligned.
bool is_within(const Metric& a, double factor, const Metric& b);

/// Least factor k such that `a` is not longer than `k b` in any direction: the largest singular
/// value of a b^-1. At most 1 if `a` is within `b`.
double growth(const Metric& a, const Metric& b);

}  // namespace controlspace
