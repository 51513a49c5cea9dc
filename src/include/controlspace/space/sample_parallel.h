// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "controlspace/space/control_space.h"

namespace controlspace {

/// As space.sample, with the same bits, on all of TBB's threads, in blocks of 64 to 2048 points
/// whose answers share no cache line. Smaller batches stay on the calling thread. Exceptions of
/// space.sample pass through.
void sample_parallel(const ControlSpace& space, std::span<const Point> x, std::span<Metric> out);

/// The same, as a new vector.
std::vector<Metric> sample_parallel(const ControlSpace& space, std::span<const Point> x);

}  // namespace controlspace
