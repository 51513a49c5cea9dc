// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "controlspace/geometry/box.h"

namespace controlspace {

/// The smallest box around the positions of items, of which there must be one.
template <class Items, class Position = std::identity>
Box extent_of(const Items& items, const Position& position = {}) {
    const Point first = std::invoke(position, *std::begin(items));
    Box box{first, first};
    for (const auto& item : items) {
        const Point p = std::invoke(position, item);
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
    }
    return box;
}

}  // namespace controlspace
