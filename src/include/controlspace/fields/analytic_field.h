#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/metric_field.h"

namespace controlspace {

/// A box without bounds.
inline Box everywhere() {
    const double infinity = std::numeric_limits<double>::infinity();
    return {Point::Constant(-infinity), Point::Constant(infinity)};
}

/// A source of metrics that is given by a formula, with what its values do not show.
struct AnalyticField {
    std::shared_ptr<const MetricField> field;
    Box definition = everywhere();  ///< where the formula holds
    double finest_length = 0;       ///< no length that it asks for is smaller
};

/// Whatever `formula` answers; it is called from several threads at once. Evaluating throws
/// InputError, naming the place, where that is not positive definite. Throws InputError for a
/// `finest_length` that is not a positive number.
AnalyticField function_field(std::function<Metric(const Point&)> formula, double finest_length,
                             const Box& definition = everywhere());

/// Throws InputError where `domain` goes beyond the field's definition; `name` is for the message.
void require_defined(const AnalyticField& field, const Box& domain, const std::string& name);

}  // namespace controlspace
