// SPDX-License-Identifier: Apache-2.0
#include "io/text/cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "controlspace/geometry/extent.h"
#include "refuse.h"

namespace controlspace {
namespace {

std::array<double, 6> key(const Box& b) {
    return {b.low.x(), b.low.y(), b.low.z(), b.high.x(), b.high.y(), b.high.z()};
}

/// Cuts `region` by the plane through a face of `element` that is nearest to its middle, in units
/// of its edges: in trees, where the tree cut it too. False where no such plane passes through.
bool cut_by_face(const Box& region, const Box& element, Box& low, Box& high) {
    double nearest = 1;
    for (Axis a = 0; a < 3; ++a) {
        for (const double plane : {element.low[a], element.high[a]}) {
            if (plane <= region.low[a] || plane >= region.high[a]) continue;
            const double off =
                std::abs(plane - region.centre()[a]) / (region.high[a] - region.low[a]);
            if (off >= nearest) continue;
            nearest = off;
            low = high = region;
            low.high[a] = high.low[a] = plane;
        }
    }
    return nearest < 1;
}

Box cell_of(const ControlSpace& space, const Point& x) {
    const auto cell = space.cell_at(x);
    if (!cell) refuse("this field has no cells: write a slice of it");
    return *cell;
}

}  // namespace

std::vector<int> cell_corners(const Box& domain) {
    const auto flat = flat_axis(domain);
    if (!flat) return {hexahedron_corners.begin(), hexahedron_corners.end()};
    const int one = 1 << (*flat + 1) % 3;
    const int other = 1 << (*flat + 2) % 3;
    return {0, one, one | other, other};
}

std::vector<Box> elements_of(const ControlSpace& space) {
    return elements_of(space, std::vector{space.domain()});
}

std::vector<Box> elements_of(const ControlSpace& space, std::span<const Box> within) {
    std::vector<Box> elements;
    std::vector<Box> regions(within.begin(), within.end());
    while (!regions.empty()) {
        const Box region = regions.back();
        regions.pop_back();
        const Box element = cell_of(space, region.centre());
        Box low, high;
        if (cut_by_face(region, element, low, high)) {
            regions.push_back(high);
            regions.push_back(low);
        } else {
            elements.push_back(element);
        }
    }
    // A plane may have cut an element that lies elsewhere.
    std::ranges::sort(elements, {}, key);
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
    return elements;
}

}  // namespace controlspace
