// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "controlspace/geometry/box.h"

namespace controlspace {

/// A box and the planes that cut it: one for a kd-tree, three for an octree. A tree of either kind
/// is a box subdivided again and again.
///
/// Children are numbered by one bit per cut axis, x lowest: 1 is the high side. A point on a plane
/// belongs to the low side. Children's faces are copies of the parent's and of `at`, never
/// computed, so faces that coincide are equal to the bit.
struct Subdivision {
    Box box;
    Point at = Point::Zero();    ///< positions of the planes; only cut axes count
    std::array<bool, 3> cuts{};  ///< which axes are cut

    int children() const { return 1 << (cuts[0] + cuts[1] + cuts[2]); }

    /// Which side of axis `a` child `c` lies on: 0 low, 1 high; 0 for an axis that is not cut.
    int side(int c, Axis a) const {
        int bit = 0;
        for (int b = 0; b < a; ++b) bit += cuts[static_cast<std::size_t>(b)];
        return cuts[static_cast<std::size_t>(a)] ? (c >> bit) & 1 : 0;
    }

    Box child(int c) const {
        Box part = box;
        for (Axis a = 0; a < 3; ++a) {
            if (!cuts[static_cast<std::size_t>(a)]) continue;
            (side(c, a) == 0 ? part.high : part.low)[a] = at[a];
        }
        return part;
    }

    /// Whether every plane lies strictly inside the box: false once floating point cannot halve it.
    bool is_proper() const {
        for (Axis a = 0; a < 3; ++a) {
            if (cuts[static_cast<std::size_t>(a)] && !(box.low[a] < at[a] && at[a] < box.high[a])) {
                return false;
            }
        }
        return true;
    }
};

/// The planes through the middle of `box`: three, or two where it is flat.
inline Subdivision octants(const Box& box) {
    const Vector e = box.edges();
    return {box, box.centre(), {e.x() > 0, e.y() > 0, e.z() > 0}};
}

/// Which axes of boxes of this level are halved, the root being level 0, so that they get near
/// cubes: those of more than half of the longest edge, beyond rounding. From the extents of the
/// domain alone, so that rounding of the boxes does not count.
inline std::array<bool, 3> long_axes(const Box& domain, int level) {
    Vector e = domain.edges();
    while (true) {
        const double half = 0.5 * (1 + 1e-9) * e.maxCoeff();
        const std::array<bool, 3> axes{e.x() > half, e.y() > half, e.z() > half};
        if (level-- == 0 || (axes[0] && axes[1] && axes[2])) return axes;
        for (Axis a = 0; a < 3; ++a) e[a] *= axes[static_cast<std::size_t>(a)] ? 0.5 : 1;
    }
}

/// One plane across axis `a` of `box`, at coordinate `cut`.
inline Subdivision halves(const Box& box, Axis a, double cut) {
    Subdivision s{box, Point::Constant(cut), {}};
    s.cuts[static_cast<std::size_t>(a)] = true;
    return s;
}

/// Across the middle of the longest edge, z before y before x where edges are equally long.
inline Subdivision longest_edge_halves(const Box& box) {
    const Vector e = box.edges();
    const Axis axis = e.x() > e.y() && e.x() > e.z() ? 0 : e.y() > e.z() ? 1 : 2;
    return halves(box, axis, 0.5 * (box.low[axis] + box.high[axis]));
}

/// Across the middle of the axis with the largest of `along` among those whose edge is at least a
/// quarter of the longest, so that no edge gets shorter than an eighth of it; across the longest
/// edge if no such entry is positive.
inline Subdivision halves_across(const Box& box, const std::array<double, 3>& along) {
    const Vector e = box.edges();
    const double shortest = e.maxCoeff() / 4;
    Axis axis = -1;
    double most = 0;
    for (Axis a = 0; a < 3; ++a) {
        const double variation = along[static_cast<std::size_t>(a)];
        if (e[a] < shortest || !(variation > most)) continue;
        most = variation;
        axis = a;
    }
    if (axis < 0) return longest_edge_halves(box);
    return halves(box, axis, 0.5 * (box.low[axis] + box.high[axis]));
}

}  // namespace controlspace
