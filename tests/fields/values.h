// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/space/control_space.h"

namespace controlspace {

inline Metric value_at(const ControlSpace& field, const Point& p) {
    Metric m;
    field.sample({&p, 1}, {&m, 1});
    return m;
}

}  // namespace controlspace
