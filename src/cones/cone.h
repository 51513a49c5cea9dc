#pragma once

#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// By how much a source's metric may have grown at `p`: 1 + (g-1) |M^-1 (p - Q)| (paper §5.2).
/// The source's cone at `p` is its metric times this factor.
inline double cone_factor(const PointSource& source, double g, const Point& p) {
    return 1 + (g - 1) * metric_length(source.metric, p - source.position);
}

}  // namespace controlspace
