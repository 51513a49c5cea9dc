#pragma once

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Non-conformity δ of two metrics (paper §2, after Labbé et al.): the Frobenius norm of
/// a^-1 b + b^-1 a - 2I, on the tensors of lengths, as in the paper's tables. Dimensionless and
/// symmetric; 0 for equal metrics, √3 (k + 1/k - 2) for a and k a.
double nonconformity(const Metric& a, const Metric& b);

/// The same on the Riemannian metrics a^-2 and b^-2, as in the paper's footnote.
double riemannian_nonconformity(const Metric& a, const Metric& b);

}  // namespace controlspace
