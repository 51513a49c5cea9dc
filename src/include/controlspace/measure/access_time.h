// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
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
/// The same for lengths.
std::uint64_t checksum(std::span<const double> lengths);

/// Quartile 1, 2 (the median) or 3 of samples in any order, between them by linear interpolation.
/// Throws InputError where there is no sample.
double quartile(std::vector<double> samples, int number);

/// What a query returns: a metric, or the smallest length that it requests in any direction.
enum class Answers { metrics, lengths };

/// How places are passed to a structure: all in one call of `sample` or `sample_lengths`; one in
/// each of `metric_at` or `length_at`, as meshers do; one in each call of a cursor.
enum class Calls { one, each, cursor };

struct AccessQuery {
    Answers answers = Answers::metrics;
    Calls calls = Calls::one;
};

/// Raw samples of the access time t_a (paper §5.1), nanoseconds per query on one thread.
struct AccessTime {
    std::vector<double> samples_ns;
    std::uint64_t checksum = 0;  ///< of the answers; equal for timed and untimed runs

    double median_ns() const { return quartile(samples_ns, 2); }
};

/// Times `query` of several structures at the same points in turns, so that other load of the
/// machine affects all of them alike. In each of the `repeats` rounds each structure answers all in
/// one call untimed, which warms the caches, and then until `shortest_s` have passed, which gives
/// one sample; a structure that has taken `most_s` gets no further ones. The clock is read twice a
/// run (about 50 ns), so the batch should have at least a thousand points. Throws std::logic_error
/// if answers differ from the first ones, or if lengths are not those of the structure's metrics;
/// InputError for no points or no repeats.
std::vector<AccessTime> access_times(std::span<const ControlSpace* const> spaces,
                                     std::span<const Point> points, int repeats,
                                     AccessQuery query = {}, double shortest_s = 0.005,
                                     double most_s = std::numeric_limits<double>::infinity());

/// The same for one structure, of metrics in batches.
AccessTime access_time(const ControlSpace& space, std::span<const Point> points, int repeats,
                       double shortest_s = 0.005);

}  // namespace controlspace
