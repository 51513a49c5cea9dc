// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>

#include "controlspace/gradation/node_graph.h"
#include "controlspace/trees/cell_model.h"

namespace controlspace {

/// Whether two different corners of a leaf are neighbours: ends of an edge, or with `all` any two.
inline bool are_neighbours(std::size_t i, std::size_t j, Neighbourhood neighbourhood) {
    return neighbourhood == Neighbourhood::all || std::has_single_bit(i ^ j);
}

/// visit(a, b) for the vertices of a leaf that are neighbours, each pair once; of a flat leaf,
/// whose corners coincide, some pairs come twice.
template <class Visit>
void for_each_pair(const Corners& corners, Neighbourhood neighbourhood, Visit&& visit) {
    for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t j = i + 1; j < 8; ++j) {
            if (corners[i] == corners[j] || !are_neighbours(i, j, neighbourhood)) continue;
            visit(corners[i], corners[j]);
        }
    }
}

}  // namespace controlspace
