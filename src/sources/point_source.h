#pragma once

#include "geometry/point.h"
#include "metric/metric.h"

namespace controlspace {

/// A discrete source: the metric asked for at a place.
struct PointSource {
    Point position = Point::Zero();
    Metric metric;
};

}  // namespace controlspace
