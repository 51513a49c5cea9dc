// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// The Riemannian metric 𝓜 = M^-2, which other programs exchange: its eigenvalues are h^-2.
Metric to_riemannian(const Metric& m);

/// M = 𝓜^-1/2, or nothing if 𝓜 is not positive definite or M cannot be the metric of a source
/// (see is_source_metric).
std::optional<Metric> from_riemannian(const Metric& riemannian);

}  // namespace controlspace
