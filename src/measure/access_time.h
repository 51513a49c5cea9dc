#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// `n` places drawn uniformly from `box`; the same for the same seed on every machine. Throws
/// InputError for more than 2^28.
std::vector<Point> random_points(const Box& box, std::size_t n, std::uint64_t seed);

/// 64-bit checksum of the metrics' bits, in order: another if any one number differs in any bit.
std::uint64_t checksum(std::span<const Metric> metrics);

/// Raw samples of the access time t_a (paper §5.1), nanoseconds per query of one batch on one
/// thread.
struct AccessTime {
    std::vector<double> samples_ns;
    std::uint64_t checksum = 0;  ///< of the answers; equal for timed and untimed runs

    /// Between samples by linear interpolation. Both throw InputError where there is no sample.
    double median_ns() const;
    double quartile_ns(int quartile) const;  ///< 1, 2 or 3
};

/// Times `sample` on one batch of all `points`. Each of the `repeats` runs the batch as often as it
/// takes to spend `shortest_s` in it and gives one sample; the clock is read twice a run (some
/// 50 ns), so the batch should have a thousand points or more. Throws std::logic_error if any timed
/// run answers otherwise than the untimed run before them, InputError for no points or no repeats.
AccessTime access_time(const ControlSpace& space, std::span<const Point> points, int repeats,
                       double shortest_s = 0.005);

}  // namespace controlspace
