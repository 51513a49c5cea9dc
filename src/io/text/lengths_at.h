// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "controlspace/space/control_space.h"

namespace controlspace {

struct Lengths {
    std::vector<double> values;
    bool has_tensors = false;  ///< whether some length depends on the direction
};

/// The smallest length in any direction at each place; on all cores.
Lengths lengths_at(const ControlSpace& space, std::span<const Point> places);

/// The largest factor between `interpolated` and the lengths of the field, at 99 % of 1000 random
/// places of its domain.
double usual_factor(const ControlSpace& space,
                    const std::function<double(const Point&)>& interpolated);

}  // namespace controlspace
