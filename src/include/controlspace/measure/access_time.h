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

/// Quartile 1, 2 (the median) or 3 of samples in any order, between them by linear interpolation.
/// Throws InputError where there is no sample.
double quartile(std::vector<double> samples, int number);

/// How places are passed to a structure: all in one call of `sample`, or one in each of
/// `metric_at`, as meshers do.
enum class Calls { one, each };

/// Raw samples of the access time t_a (paper §5.1), nanoseconds per query on one thread.
struct AccessTime {
    std::vector<double> samples_ns;
    std::uint64_t checksum = 0;  ///< of the answers; equal for timed and untimed runs

    double median_ns() const { return quartile(samples_ns, 2); }
};

/// Times `sample`, or `metric_at` place by place, of several structures at the same points in
/// turns, so that other load of the machine affects all of them alike. In each of the `repeats`
/// rounds each structure answers all in one call untimed, which warms the caches, and then until
/// `shortest_s` have passed, which gives one sample. The clock is read twice a run (about 50 ns),
/// so the batch should have at least a thousand points. Throws std::logic_error if answers differ
/// from the first ones, InputError for no points or no repeats.
std::vector<AccessTime> access_times(std::span<const ControlSpace* const> spaces,
                                     std::span<const Point> points, int repeats,
                                     Calls calls = Calls::one, double shortest_s = 0.005);

/// The same for one structure.
AccessTime access_time(const ControlSpace& space, std::span<const Point> points, int repeats,
                       double shortest_s = 0.005);

}  // namespace controlspace
