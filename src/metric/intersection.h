#pragma once

#include "metric/metric.h"

namespace controlspace {

/// The largest metric that is never longer than `a` or `b` along any direction (paper §2, "min"):
/// simultaneous reduction of the Riemannian metrics, A^1/2 max(1, eig(A^-1/2 B A^-1/2)) A^1/2 with
/// A = a^-2, B = b^-2.
///
/// `a` itself where it lies within `b`, and `b` itself where it lies within `a`, to the bit.
/// Commutes up to rounding; taken over three or more metrics the result depends on their order.
Metric intersection(const Metric& a, const Metric& b);

/// Whether `a` is nowhere longer than `factor * b`, up to a relative 1e-14.
bool is_within(const Metric& a, double factor, const Metric& b);

/// Least factor k such that `a` is nowhere longer than `k b`: the largest singular value of
/// a b^-1. 1 or less where `a` lies within `b`.
double growth(const Metric& a, const Metric& b);

}  // namespace controlspace
