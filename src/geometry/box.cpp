#include "geometry/box.h"

#include <fmt/format.h>

#include <cmath>

#include "error.h"

namespace controlspace {

Box bounding_box(std::span<const Point> points, double margin) {
    if (points.empty()) throw InputError("a box around no points: give at least one source");
    Box box{points.front(), points.front()};
    for (const Point& p : points) {
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
    }
    const double longest = box.edges().maxCoeff();
    const double extent = longest > 0 ? longest : 1;
    for (Axis a = 0; a < 3; ++a) {
        const double outwards = margin * extent + (box.edges()[a] > 0 ? 0 : 0.5 * extent);
        box.low[a] -= outwards;
        box.high[a] += outwards;
    }
    return box;
}

const Box& require_volume(const Box& box) {
    for (Axis a = 0; a < 3; ++a) {
        const double edge = box.edges()[a];
        if (!std::isfinite(edge) || !(edge > 0)) {
            throw InputError(
                fmt::format("domain {} has no extent along {}: give low < high, finite",
                            to_string(box), "xyz"[a]));
        }
    }
    return box;
}

std::string to_string(const Box& box) {
    return fmt::format("[{}, {}] x [{}, {}] x [{}, {}]", box.low.x(), box.high.x(), box.low.y(),
                       box.high.y(), box.low.z(), box.high.z());
}

}  // namespace controlspace
