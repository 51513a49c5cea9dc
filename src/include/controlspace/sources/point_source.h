#pragma once

#include <span>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// A discrete source: the metric asked for at a place.
struct PointSource {
    Point position = Point::Zero();
    Metric metric;

    bool operator==(const PointSource&) const = default;
};

/// Smallest length that any of the sources asks for, in any direction. Throws InputError for none.
double finest_length(std::span<const PointSource> sources);

/// Whether a number can be a coordinate, a desired length, a metric of a source.
bool is_coordinate(double x);
bool is_length(double h);
bool is_source_metric(const Metric& m);

}  // namespace controlspace
