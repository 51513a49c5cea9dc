// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "controlspace/metric/metric.h"
#include "controlspace/space/adaptation.h"

namespace controlspace {

/// Adapts so that what is read back in the precision of `goal` keeps its target. `adapt` follows a
/// goal in doubles; `held` gives the metrics that are held afterwards. M_max is `longest`. Weights
/// of nodes are from 0 to 1 up to `order` 1; those of quadratic leaves reach beyond, and are taken
/// to round twice as far, as a ratio.
///
/// Rounding by a factor r takes an answer that is within a factor k of the field to within k r at
/// most: blends are convex, and bounds of tensors along all directions survive them. So the target
/// is that of k / r. How far codes of 8 bits round depends on the lengths that are held, which are
/// known afterwards: where they round by more than was taken off, it is adapted again.
AdaptationReport adapt_for_precision(
    const AdaptationGoal& goal, double longest, int order,
    const std::function<AdaptationReport(const AdaptationGoal&)>& adapt,
    const std::function<std::vector<Metric>()>& held);

}  // namespace controlspace
