#pragma once

#include <span>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// A metric at every point of space, without a structure: what structures are made to follow, and
/// what they are measured against. Reading is thread-safe.
class MetricField {
public:
    virtual ~MetricField() = default;

    /// Metrics at `x`; out.size() == x.size(). Large batches run on all of TBB's threads.
    virtual void evaluate(std::span<const Point> x, std::span<Metric> out) const = 0;
};

/// Metric at one point.
inline Metric metric_at(const MetricField& field, const Point& x) {
    Metric m;
    field.evaluate({&x, 1}, {&m, 1});
    return m;
}

}  // namespace controlspace
