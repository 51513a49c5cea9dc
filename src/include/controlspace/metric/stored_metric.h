#pragma once

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Type of the numbers in the metrics of a compact form.
enum class Precision { doubles, floats };

/// A metric in six numbers of another type; floats round each by a relative 6e-8 at most.
template <class Number>
struct StoredMetric {
    Number xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;

    StoredMetric() = default;
    explicit StoredMetric(const Metric& m)
        : xx(static_cast<Number>(m.xx)),
          yy(static_cast<Number>(m.yy)),
          zz(static_cast<Number>(m.zz)),
          xy(static_cast<Number>(m.xy)),
          xz(static_cast<Number>(m.xz)),
          yz(static_cast<Number>(m.yz)) {}
    operator Metric() const { return {xx, yy, zz, xy, xz, yz}; }
};

}  // namespace controlspace
