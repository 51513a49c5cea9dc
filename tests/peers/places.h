// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "controlspace/geometry/box.h"
#include "geometry/random_fractions.h"

namespace controlspace {

/// Oblong, away from the origin.
inline const Box oblong{Point(1, -2, 3), Point(3, -1, 4.5)};

/// Random places in the box.
inline std::vector<Point> places_in(const Box& box, std::size_t count) {
    RandomFractions random(7);
    std::vector<Point> x(count);
    for (Point& p : x) {
        for (Axis a = 0; a < 3; ++a) p[a] = box.low[a] + random() * box.edges()[a];
    }
    return x;
}

}  // namespace controlspace
