#pragma once

#include "controlspace/metric/metric_field.h"

namespace controlspace {

inline Metric value_at(const MetricField& field, const Point& p) {
    Metric m;
    field.evaluate({&p, 1}, {&m, 1});
    return m;
}

}  // namespace controlspace
