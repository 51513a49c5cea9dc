#pragma once

#include <span>

#include "controlspace/space/control_space.h"

namespace controlspace {

/// As space.sample, the same bits, on all of TBB's threads: blocks of some thousand places, whose
/// answers share no line of a cache. Smaller batches stay on the calling thread.
void sample_parallel(const ControlSpace& space, std::span<const Point> x, std::span<Metric> out);

}  // namespace controlspace
