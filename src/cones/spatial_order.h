// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Numbers of the points along a Z-shaped curve through their bounding box, so that most points are
/// near the one before. For at most 2^32 points.
std::vector<std::uint32_t> spatial_order(std::span<const Point> points);

}  // namespace controlspace
