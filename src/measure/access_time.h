#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.h"
#include "spaces/control_space.h"

namespace controlspace {

/// `n` places drawn uniformly from `box`; the same for the same seed on every machine.
std::vector<Point> random_points(const Box& box, std::size_t n, std::uint64_t seed);

/// 64-bit checksum of the metrics' bits, in order.
std::uint64_t checksum(std::span<const Metric> metrics);

/// Raw samples of the access time t_a (paper §5.1), nanoseconds per query of one batch on one
/// thread.
struct AccessTime {
    std::vector<double> samples_ns;
    std::uint64_t checksum = 0;  ///< of the answers; equal for timed and untimed runs

    double median_ns() const;
    double quartile_ns(int quartile) const;  ///< 1, 2 or 3
};

/// Times `sample` on one batch of all `points`, `repeats` times, each repeat long enough (at least
/// `shortest_s`) that the clock does not matter. Throws std::logic_error if any timed run answers
/// otherwise than the untimed run before it did.
AccessTime access_time(const ControlSpace& space, std::span<const Point> points, int repeats,
                       double shortest_s = 0.005);

}  // namespace controlspace
