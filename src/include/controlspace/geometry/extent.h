// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "controlspace/geometry/box.h"

namespace controlspace {

// A domain is a box with a volume, or a flat one: a plane across one axis, along which low == high.

/// The axis along which a box has no extent; none of a box with a volume.
inline std::optional<Axis> flat_axis(const Box& box) {
    for (Axis a = 0; a < 3; ++a) {
        if (box.low[a] == box.high[a]) return a;
    }
    return std::nullopt;
}

/// The edges, for quotients of lengths in the box: 1 in place of 0, where lengths are 0 too.
inline Vector divisible_edges(const Box& box) {
    const Vector e = box.edges();
    return {e.x() == 0 ? 1 : e.x(), e.y() == 0 ? 1 : e.y(), e.z() == 0 ? 1 : e.z()};
}

/// Volume of a box; area of a flat one.
inline double measure(const Box& box) { return divisible_edges(box).prod(); }

/// `box` itself. Throws InputError as require_volume does, but lets a box be flat across one axis.
const Box& require_extent(const Box& box);

}  // namespace controlspace
