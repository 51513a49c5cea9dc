// SPDX-License-Identifier: Apache-2.0
#include "controlspace/geometry/box.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "controlspace/error.h"
#include "controlspace/geometry/extent.h"
#include "geometry/extent_of.h"

namespace controlspace {

Box bounding_box(std::span<const Point> points, double margin) {
    if (points.empty()) throw InputError("a box around no points: give at least one source");
    Box box = extent_of(points);
    const double longest = box.edges().maxCoeff();
    const double extent = longest > 0 ? longest : 1;
    for (Axis a = 0; a < 3; ++a) {
        const double outwards = margin * extent + (box.edges()[a] > 0 ? 0 : 0.5 * extent);
        box.low[a] -= outwards;
        box.high[a] += outwards;
    }
    return box;
}

namespace {

void require_resolved(const Box& box, bool may_be_flat) {
    // With fewer places across it than this, boxes within it cannot be halved as often as needed.
    constexpr double least_places = 1e6;
    for (Axis a = 0; a < 3; ++a) {
        const auto fail = [&](std::string_view what, std::string_view remedy) {
            throw InputError(
                fmt::format("domain {} {} along {}: {}", to_string(box), what, "xyz"[a], remedy));
        };
        const double edge = box.edges()[a];
        const double farthest = std::max(std::abs(box.low[a]), std::abs(box.high[a]));
        const bool is_flat = may_be_flat && edge == 0;
        if (!(edge > 0) && !is_flat) fail("has no extent", "give low < high, finite");
        if (farthest > largest_magnitude) {
            fail(fmt::format("goes beyond {:.0e}", largest_magnitude),
                 "give another unit of length");
        }
        if (is_flat) continue;
        if (edge < 1 / largest_magnitude) {
            fail(fmt::format("is shorter than {:.0e}", 1 / largest_magnitude),
                 "give another unit of length");
        }
        if (edge < least_places * std::numeric_limits<double>::epsilon() * farthest) {
            fail("is too thin for its distance from the origin", "move the origin nearer");
        }
    }
}

}  // namespace

const Box& require_volume(const Box& box) {
    require_resolved(box, false);
    return box;
}

const Box& require_extent(const Box& box) {
    require_resolved(box, true);
    if ((box.edges().array() == 0).count() > 1) {
        throw InputError(
            fmt::format("domain {} has no extent along two axes or more: give low < high along two "
                        "at least",
                        to_string(box)));
    }
    return box;
}

std::string to_string(const Box& box) {
    return fmt::format("[{}, {}] x [{}, {}] x [{}, {}]", box.low.x(), box.high.x(), box.low.y(),
                       box.high.y(), box.low.z(), box.high.z());
}

}  // namespace controlspace
