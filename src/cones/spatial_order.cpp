// SPDX-License-Identifier: Apache-2.0
#include "cones/spatial_order.h"

#include <algorithm>

#include "geometry/extent_of.h"

namespace controlspace {

namespace {

// Ten bits, two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 16) & 0x30000ff;
    bits = (bits | bits << 8) & 0x300f00f;
    bits = (bits | bits << 4) & 0x30c30c3;
    return (bits | bits << 2) & 0x9249249;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Point> points) {
    std::vector<std::uint32_t> order(points.size());
    if (points.empty()) return order;
    const Box extent = extent_of(points);
    constexpr double cells = 1024;
    const Vector scale = cells / extent.edges().array();
    // What is no number, or not finite, goes to either end.
    const auto cell = [&](const Point& p, Axis a) {
        const double c = (p[a] - extent.low[a]) * scale[a];
        return c > 0 ? static_cast<std::uint64_t>(std::min(c, cells - 1)) : 0;
    };
    std::vector<std::uint64_t> keys(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point& p = points[i];
        keys[i] =
            (spread(cell(p, 0)) | spread(cell(p, 1)) << 1 | spread(cell(p, 2)) << 2) << 32 | i;
    }
    if (!std::is_sorted(keys.begin(), keys.end())) std::sort(keys.begin(), keys.end());
    std::transform(keys.begin(), keys.end(), order.begin(),
                   [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
    return order;
}

}  // namespace controlspace
