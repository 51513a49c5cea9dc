// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/point_source.h"

#include <algorithm>
#include <cmath>

#include "refuse.h"

namespace controlspace {

double finest_length(std::span<const PointSource> sources) {
    if (sources.empty()) refuse("no sources: give at least one");
    double finest = largest_magnitude;
    for (const PointSource& source : sources) {
        finest = std::min(finest, eigen_frame(source.metric).lengths[0]);
    }
    return finest;
}

bool all_isotropic(std::span<const PointSource> sources) {
    return std::ranges::all_of(sources, is_isotropic, &PointSource::metric);
}

bool is_coordinate(double x) { return std::abs(x) <= largest_magnitude; }

bool is_length(double h) { return h >= 1 / largest_magnitude && h <= largest_magnitude; }

bool is_source_metric(const Metric& m) {
    return is_positive_definite(m) && is_length(m.xx) && is_length(m.yy) && is_length(m.zz);
}

bool is_source_growth(double g) { return g == 0 || (g >= 1 && g <= 1e6); }

void require_length(std::string_view name, double value) {
    if (is_length(value)) return;
    refuse("{} = {}: give a positive number", name, value);
}

void require_coordinates(std::string_view name, const Point& p) {
    if (std::all_of(p.begin(), p.end(), is_coordinate)) return;
    refuse("{} = ({}, {}, {}): give three finite coordinates", name, p.x(), p.y(), p.z());
}

}  // namespace controlspace
