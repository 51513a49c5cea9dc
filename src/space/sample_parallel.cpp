// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/sample_parallel.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

#include "geometry/threads.h"

namespace controlspace {

namespace {

constexpr std::size_t line = 64;  // bytes of a cache line
// Metrics after which a line begins again.
constexpr std::size_t step = 4;
static_assert(step * sizeof(Metric) % line == 0);
// Points per task. A task costs about a microsecond: as much as some 50 queries of a structure.
constexpr std::size_t largest_block = 2048;
constexpr std::size_t smallest_block = 64;
static_assert(smallest_block % step == 0);

// The number of metrics from `first` to the next that begins a line, if any does.
std::size_t up_to_line(const Metric* first) {
    for (std::size_t i = 0; i < step; ++i) {
        if (reinterpret_cast<std::uintptr_t>(first + i) % line == 0) return i;
    }
    return 0;
}

}  // namespace

void sample_parallel(const ControlSpace& space, std::span<const Point> x, std::span<Metric> out) {
    if (x.size() <= smallest_block) {
        space.sample(x, out);
        return;
    }
    // Enough blocks for fields of which a query takes long in some places.
    const std::size_t share = x.size() / (8 * threads_allowed());
    const std::size_t block = std::clamp(share / step * step, smallest_block, largest_block);
    // The first block is longer, so that all others begin a line.
    const std::size_t offset = up_to_line(out.data());
    const std::size_t blocks = (x.size() - offset + block - 1) / block;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t i) {
        const std::size_t begin = i == 0 ? 0 : offset + i * block;
        const std::size_t end = std::min(offset + (i + 1) * block, x.size());
        space.sample(x.subspan(begin, end - begin), out.subspan(begin, end - begin));
    });
}

std::vector<Metric> sample_parallel(const ControlSpace& space, std::span<const Point> x) {
    std::vector<Metric> metrics(x.size());
    sample_parallel(space, x, metrics);
    return metrics;
}

}  // namespace controlspace
