// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

/// Lengths in a box, trilinear between those at its corners (numbered as by `corner`).
struct TrilinearLengths {
    Box box;
    std::array<double, 8> at;

    double at_place(const Point& x) const;
    /// Upper bound of the slope in the box.
    double slope() const;
    /// The same lengths in both halves across the longest edge.
    std::pair<TrilinearLengths, TrilinearLengths> halves() const;
};

/// Where something does not hold, or could not be shown to.
struct Doubt {
    Point where;
    bool is_certain;  ///< it does not hold there
};

}  // namespace controlspace
