// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "controlspace/metric/intersection.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/source_columns.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// The exact graded field, defined everywhere: at p, the intersection of `largest`, the cones
/// M_i (1 + (g-1) |M_i^-1 (p - Q_i)|) of all sources i and, if there is one, a `continuous` field.
///
/// Order-free, it is the largest metric within all of them, up to `tolerance` (ConeField). In turn
/// (paper §5.2), they are intersected one after the other, in the order of their smallest lengths
/// at p, ascending, and of their indices where equal: the intersection of three or more tensors
/// depends on the order.
///
/// A query takes microseconds for isotropic sources, whatever their number. The time for
/// anisotropic ones in turn follows from the definition: about one source in thirty of a
/// thin-layered sphere shortens the metric at a point, each by a small amount (0.25 ms a query for
/// 36186 sources). A `tolerance` t above 0 omits those that would shorten it by less than that
/// fraction; the non-conformity to the exact field was at most 2.3 t^2 in all fields tested.
///
/// Throws InputError, naming the source by its index (0-based), for a position that is not finite
/// or a metric that is not positive definite; for a gradation ratio g < 1 or not finite; for such a
/// `largest`; for a tolerance that is negative or not finite.
std::unique_ptr<ControlSpace> exact_reference(const SourceColumns& sources, double g,
                                              const Metric& largest, double tolerance = 0,
                                              IntersectionRule rule = IntersectionRule::order_free,
                                              std::shared_ptr<const ControlSpace> continuous = {});
std::unique_ptr<ControlSpace> exact_reference(const std::vector<PointSource>& sources, double g,
                                              const Metric& largest, double tolerance = 0,
                                              IntersectionRule rule = IntersectionRule::order_free,
                                              std::shared_ptr<const ControlSpace> continuous = {});

/// The field in turn by intersecting with every source, without a search: the oracle of the tests.
std::unique_ptr<ControlSpace> brute_force_reference(std::vector<PointSource> sources, double g,
                                                    const Metric& largest);

}  // namespace controlspace
