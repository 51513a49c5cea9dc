// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// The gradation ratio of a cone, in a field of ratio g; `own` is that of its source, or 0.
inline double cone_growth(double own, double g) { return own > 0 ? own : g; }
inline double cone_growth(const PointSource& source, double g) {
    return cone_growth(source.growth, g);
}

/// The largest of all sources' cones; g if there are none. A span or vector of sources, or
/// SourceColumns.
template <class Sources>
double largest_growth(const Sources& sources, double g) {
    double largest = sources.empty() ? g : 1;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        largest = std::max(largest, cone_growth(sources[i], g));
    }
    return largest;
}

/// By how much a source's metric may have grown at `p`: 1 + (g-1) |M^-1 (p - Q)| (paper §5.2), with
/// the ratio of the source itself if it has one. The source's cone at `p` is its metric times this
/// factor.
inline double cone_factor(const PointSource& source, double g, const Point& p) {
    return 1 + (cone_growth(source, g) - 1) * metric_length(source.metric, p - source.position);
}

}  // namespace controlspace
