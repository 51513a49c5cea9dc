#include "controlspace/sources/point_source.h"

#include <algorithm>
#include <cmath>

#include "controlspace/error.h"

namespace controlspace {

double finest_length(std::span<const PointSource> sources) {
    if (sources.empty()) throw InputError("no sources: give at least one");
    double finest = largest_magnitude;
    for (const PointSource& source : sources) {
        finest = std::min(finest, eigen_frame(source.metric).lengths[0]);
    }
    return finest;
}

bool is_coordinate(double x) { return std::abs(x) <= largest_magnitude; }

bool is_length(double h) { return h >= 1 / largest_magnitude && h <= largest_magnitude; }

bool is_source_metric(const Metric& m) {
    return is_positive_definite(m) && is_length(mean_length(m));
}

}  // namespace controlspace
