// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// A point source: the metric requested at a position (paper §2).
struct PointSource {
    Point position = Point::Zero();
    Metric metric;
    /// Gradation ratio of this source's cone, 1 or more; 0 stands for the ratio of the field, g_r.
    double growth = 0;

    bool operator==(const PointSource&) const = default;
};

/// Smallest length that any of the sources requests in any direction. Throws InputError if there
/// are none.
double finest_length(std::span<const PointSource> sources);

/// Whether all have isotropic metrics.
bool all_isotropic(std::span<const PointSource> sources);

/// Whether a number can be a coordinate (finite, up to largest_magnitude), a length (positive, and
/// its inverse too); whether a metric can be that of a source (positive definite, its diagonal of
/// lengths).
bool is_coordinate(double x);
bool is_length(double h);
bool is_source_metric(const Metric& m);
/// Whether a number can be the gradation ratio of a source: 0, or from 1 to 1e6.
bool is_source_growth(double g);

/// Throw InputError, with the name, unless `value` is a length, all of `p` are coordinates.
void require_length(std::string_view name, double value);
void require_coordinates(std::string_view name, const Point& p);

}  // namespace controlspace
