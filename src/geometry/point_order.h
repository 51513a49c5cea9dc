// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// An order of places, by x, then y, then z: for sorting, so that equal ones come together.
inline bool precedes(const Point& a, const Point& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace controlspace
