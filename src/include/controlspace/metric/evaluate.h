#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// What MetricField::evaluate is written with: `block(points, metrics)` for parts of `x` and `out`,
/// on all of TBB's threads. Exceptions pass through.
template <class Block>
void evaluate_blocks(std::span<const Point> x, std::span<Metric> out, Block&& block) {
    constexpr std::size_t points_per_task = 64;  // enough that a task's start does not matter
    assert(x.size() == out.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, x.size(), points_per_task),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          block(x.subspan(range.begin(), range.size()),
                                out.subspan(range.begin(), range.size()));
                      });
}

/// out[i] = at(x[i]), in the same way.
template <class At>
void evaluate_each(std::span<const Point> x, std::span<Metric> out, At&& at) {
    evaluate_blocks(x, out, [&](auto points, auto metrics) {
        std::transform(points.begin(), points.end(), metrics.begin(), at);
    });
}

}  // namespace controlspace
