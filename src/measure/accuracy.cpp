// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/accuracy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/sample_parallel.h"
#include "refuse.h"

namespace controlspace {

namespace {

// Blocks do not depend on the number of threads, and are summed in order: neither does the result.
constexpr std::size_t block_size = 4096;

// What is no metric at all counts as infinitely wrong; comparisons would pass over a NaN.
double or_infinite(double delta) {
    return std::isnan(delta) ? std::numeric_limits<double>::infinity() : delta;
}

template <class Block>
void for_each_block(std::size_t n, Block&& block) {
    tbb::parallel_for(std::size_t{0}, (n + block_size - 1) / block_size, [&](std::size_t b) {
        const std::size_t begin = b * block_size;
        block(b, begin, std::min(begin + block_size, n));
    });
}

// The least of `values` that at least `percent` per cent of them do not exceed (nearest rank).
// Reorders them; there must be one.
double percentile(std::vector<double>& values, std::size_t percent) {
    const std::size_t rank = (values.size() * percent + 99) / 100;
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

// By how much lengths exceed others, at most, and at how many points.
struct Excess {
    double max = 0;
    std::size_t count = 0;

    void note(const Metric& m, const Metric& other) {
        // The ratio itself is expensive for tensors: computed where it may be the largest.
        if (!is_within(m, max, other)) max = std::max(max, growth(m, other));
        if (!is_within(m, 1 + coarser_tolerance, other)) ++count;
    }
    void note_infinite() { join({std::numeric_limits<double>::infinity(), 1}); }
    void join(const Excess& more) {
        max = std::max(max, more.max);
        count += more.count;
    }
};

}  // namespace

std::array<int, 3> cell_counts(const Box& box, int n) {
    std::array<int, 3> counts{n, n, n};
    if (const auto flat = flat_axis(box)) counts[static_cast<std::size_t>(*flat)] = 1;
    return counts;
}

std::vector<Point> cell_centres(const Box& box, int n) {
    constexpr int most = 512;
    if (n < 1 || n > most) refuse("{} cells along each axis: give 1 to {}", n, most);
    const auto coordinate = [&](Axis a, int k) {
        const double edge = box.high[a] - box.low[a];
        return box.low[a] + edge / (2 * n) + (k * edge) / n;
    };
    const std::array<int, 3> counts = cell_counts(box, n);
    std::vector<Point> points;
    points.reserve(static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
                   static_cast<std::size_t>(counts[2]));
    for (int k = 0; k < counts[2]; ++k) {
        for (int j = 0; j < counts[1]; ++j) {
            for (int i = 0; i < counts[0]; ++i) {
                points.emplace_back(coordinate(0, i), coordinate(1, j), coordinate(2, k));
            }
        }
    }
    return points;
}

Probes make_probes(const ControlSpace& field, std::vector<Point> points) {
    std::vector<Metric> reference = sample_parallel(field, points);
    return {std::move(points), std::move(reference)};
}

Accuracy accuracy(const ControlSpace& space, const Probes& probes) {
    const std::size_t n = probes.points.size();
    if (n == 0) refuse("accuracy at no places: give at least one probe");
    struct Partial {
        double sum = 0;
        double riemannian_max = 0;
        Excess coarser, finer;
    };
    std::vector<double> deltas(n);
    std::vector<Partial> partials((n + block_size - 1) / block_size);
    for_each_block(n, [&](std::size_t b, std::size_t begin, std::size_t end) {
        std::vector<Metric> values(end - begin);
        space.sample(std::span(probes.points).subspan(begin, end - begin), values);
        Partial& partial = partials[b];
        for (std::size_t i = begin; i < end; ++i) {
            const Metric& value = values[i - begin];
            const Metric& reference = probes.reference[i];
            deltas[i] = or_infinite(nonconformity(value, reference));
            partial.sum += deltas[i];
            partial.riemannian_max = std::max(
                partial.riemannian_max, or_infinite(riemannian_nonconformity(value, reference)));
            if (is_positive_definite(value)) {
                partial.coarser.note(value, reference);
                partial.finer.note(reference, value);
            } else {
                partial.coarser.note_infinite();
                partial.finer.note_infinite();
            }
        }
    });

    Accuracy result;
    Excess coarser, finer;
    for (const Partial& partial : partials) {
        result.mean += partial.sum;
        result.riemannian_max = std::max(result.riemannian_max, partial.riemannian_max);
        coarser.join(partial.coarser);
        finer.join(partial.finer);
    }
    result.mean /= static_cast<double>(n);
    result.coarser_max = coarser.max;
    result.coarser_share = static_cast<double>(coarser.count) / static_cast<double>(n);
    result.finer_max = finer.max;
    result.finer_share = static_cast<double>(finer.count) / static_cast<double>(n);
    const auto worst = std::max_element(deltas.begin(), deltas.end());
    result.max = *worst;
    result.worst = probes.points[static_cast<std::size_t>(worst - deltas.begin())];
    result.p95 = percentile(deltas, 95);
    result.p99 = percentile(deltas, 99);
    return result;
}

double source_accuracy(const ControlSpace& space, std::span<const PointSource> sources) {
    std::vector<double> partials((sources.size() + block_size - 1) / block_size, 0.0);
    for_each_block(sources.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
        std::vector<Point> places(end - begin);
        std::vector<Metric> values(end - begin);
        for (std::size_t i = begin; i < end; ++i) places[i - begin] = sources[i].position;
        space.sample(places, values);
        for (std::size_t i = begin; i < end; ++i) {
            partials[b] = std::max(
                partials[b], or_infinite(nonconformity(values[i - begin], sources[i].metric)));
        }
    });
    return partials.empty() ? 0 : *std::max_element(partials.begin(), partials.end());
}

}  // namespace controlspace
