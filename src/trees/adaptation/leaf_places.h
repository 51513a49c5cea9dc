// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "controlspace/geometry/box.h"

namespace controlspace {

/// Where a leaf is compared with the field, each coordinate in units of its edges: corners, centre,
/// centres of faces (low z, y, x, high x, y, z), middles of edges.
struct LeafPlaces {
    static constexpr std::size_t corners = 0, centre = corners + 8, faces = centre + 1,
                                 edges = faces + 6, all = edges + 12;
    std::array<Vector, all> at;
    /// On edges, a quarter from their middles, then on faces, a quarter from two middles of edges.
    static constexpr std::size_t between_on_edges = 24, between = between_on_edges + 24;
    std::array<Vector, between> at_between;

    LeafPlaces();
    static constexpr std::size_t low_face(std::size_t axis) { return faces + 2 - axis; }
    static constexpr std::size_t high_face(std::size_t axis) { return faces + 3 + axis; }
    /// To the bit that of the leaves beside it, and of parts of the leaf.
    Point in(const Box& box, std::size_t i) const {
        const Point middle = box.centre();
        Point x;
        for (Axis a = 0; a < 3; ++a) {
            x[a] = at[i][a] == 0.5 ? middle[a] : at[i][a] == 0 ? box.low[a] : box.high[a];
        }
        return x;
    }
};
const LeafPlaces& leaf_places();

}  // namespace controlspace
