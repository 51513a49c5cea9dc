// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/riemannian.h"

#include <cmath>

#include "controlspace/sources/point_source.h"

namespace controlspace {

Metric to_riemannian(const Metric& m) {
    EigenFrame frame = eigen_frame(m);
    for (double& h : frame.lengths) h = 1 / (h * h);
    return metric_from_frame(frame.lengths, frame.directions);
}

std::optional<Metric> from_riemannian(const Metric& riemannian) {
    if (!is_positive_definite(riemannian)) return std::nullopt;
    EigenFrame frame = eigen_frame(riemannian);
    for (double& length : frame.lengths) length = 1 / std::sqrt(length);
    const Metric m = metric_from_frame(frame.lengths, frame.directions);
    if (!is_source_metric(m)) return std::nullopt;
    return m;
}

}  // namespace controlspace
