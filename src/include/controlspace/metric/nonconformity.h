// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Non-conformity δ of two metrics (paper §2, after Labbé et al.): the Frobenius norm of
/// a^-1 b + b^-1 a - 2I, on the tensors of lengths, as in the paper's tables. Dimensionless and
/// symmetric; 0 for equal metrics, √3 (k + 1/k - 2) for a and k a.
double nonconformity(const Metric& a, const Metric& b);

/// The larger of δ and k + 1/k - 2, which is δ where lengths differ by the factor k along one
/// direction alone: what adaptation keeps below its target. At 0.1 no length is off by more than
/// 1.37, and of isotropic metrics, for which it is δ, by 1.27. δ alone may be small where thin
/// metrics are turned a little, although some length differs by several times.
double directional_nonconformity(const Metric& a, const Metric& b);

/// The largest factor, at least 1, between lengths of two metrics along one direction.
double largest_ratio(const Metric& a, const Metric& b);

/// √3 (k + 1/k - 2): δ of isotropic metrics that differ by a factor k > 0.
double nonconformity_of_factor(double k);

/// Its inverse: the k >= 1 that has this δ.
double largest_factor_within(double delta);

/// The same for a factor along one direction alone: k + 1/k - 2, and its inverse.
double nonconformity_along(double k);
double largest_factor_along(double delta);

/// δ of the Riemannian metrics a^-2 and b^-2, as in the paper (§3.1, footnote 2).
double riemannian_nonconformity(const Metric& a, const Metric& b);

}  // namespace controlspace
