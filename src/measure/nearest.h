// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "controlspace/geometry/point.h"
#include "controlspace/gradation/node_graph.h"

namespace controlspace {

/// Each of `points` with the `most` points nearest to it that are not at its very place, nearest
/// first; fewer where there are no more. For at most 2^32 points.
NodeGraph nearest_neighbours(std::span<const Point> points, std::size_t most);

}  // namespace controlspace
