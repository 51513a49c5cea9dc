// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "controlspace/geometry/box.h"

namespace controlspace {

/// Place `k` of an endless sequence that fills the box evenly (the additive recurrence R_3, on the
/// powers of the root of x^4 = x + 1).
inline Point place_in(const Box& box, std::uint64_t k) {
    constexpr double root = 1.2207440846057596;
    Vector t;
    double step = 1;
    for (Axis a = 0; a < 3; ++a) {
        step /= root;
        const double turns = 0.5 + step * static_cast<double>(k);
        t[a] = turns - std::floor(turns);
    }
    return box.low + t.cwiseProduct(box.edges());
}

}  // namespace controlspace
