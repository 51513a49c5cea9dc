#pragma once

#include <memory>
#include <vector>

#include "controlspace/metric/metric_field.h"

namespace controlspace {

/// The intersection of `fields`, one after the other in their order: what a mesh should follow that
/// an analytic field and discrete sources are asked of at once. None of them is changed first, so
/// an analytic field that grows faster than the sources' cones keeps its growth. Throws InputError
/// for no fields.
std::unique_ptr<MetricField> mixture(std::vector<std::shared_ptr<const MetricField>> fields);

}  // namespace controlspace
