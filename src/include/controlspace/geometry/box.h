// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Axis-aligned box, closed: `low` and `high` belong to it. In the unit of length of the domain.
struct Box {
    Point low = Point::Zero();
    Point high = Point::Zero();

    /// All of space.
    static Box everywhere() {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        return {Point::Constant(-infinity), Point::Constant(infinity)};
    }

    Vector edges() const { return high - low; }
    Point centre() const { return 0.5 * (low + high); }
    double half_diagonal() const { return 0.5 * edges().norm(); }
    bool contains(const Point& x) const {
        return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
    }
    bool operator==(const Box&) const = default;
};

/// Corner `i` of `box`: bit 0 of `i` picks the high side in x, bit 1 in y, bit 2 in z.
inline Point corner(const Box& box, int i) {
    return {(i & 1) != 0 ? box.high.x() : box.low.x(), (i & 2) != 0 ? box.high.y() : box.low.y(),
            (i & 4) != 0 ? box.high.z() : box.low.z()};
}

/// The point of `box` nearest to `x`.
inline Point nearest_in(const Box& box, const Point& x) {
    return x.cwiseMax(box.low).cwiseMin(box.high);
}

/// Whether two boxes have a place in common.
inline bool touch(const Box& a, const Box& b) {
    return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

/// Smallest box around `points`, each side moved outwards by `margin` times the longest edge.
/// Where the points have no extent along an axis (a plane, a line, one point), the box gets that of
/// its longest edge, or 1 if there is none, so that it always has a volume. Throws InputError for
/// no points.
Box bounding_box(std::span<const Point> points, double margin);

/// `box` itself. Throws InputError, naming the axis, if floating point cannot resolve it: an edge
/// that is zero, negative, not finite or shorter than 1 / largest_magnitude, coordinates beyond
/// largest_magnitude, or an edge shorter than 2e-10 of its distance from the origin.
const Box& require_volume(const Box& box);

/// "[x0, x1] x [y0, y1] x [z0, z1]", for messages.
std::string to_string(const Box& box);

}  // namespace controlspace
