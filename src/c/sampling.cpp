// SPDX-License-Identifier: Apache-2.0
// What the C library answers: metrics, lengths, Gmsh's size callbacks, and conversions of metrics.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "c/handle.h"
#include "controlspace/mesh/conformity.h"
#include "controlspace/sources/riemannian.h"

namespace {

using namespace controlspace;

// Calls `action(begin, end)` for parts of 0..n, large batches on all cores.
template <class Action>
void in_blocks(std::size_t n, Action&& action) {
    constexpr std::size_t large = 100000, block = 2048;
    if (n < large) {
        action(std::size_t{0}, n);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, block),
                      [&](const auto& part) { action(part.begin(), part.end()); });
}

// The first i below n for which `wrong(i)`, or n. All before it are visited.
template <class Wrong>
std::size_t first_where(std::size_t n, Wrong&& wrong) {
    std::atomic<std::size_t> first = n;
    in_blocks(n, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && i < first; ++i) {
            if (!wrong(i)) continue;
            std::size_t seen = first;
            while (i < seen && !first.compare_exchange_weak(seen, i)) {
            }
        }
    });
    return first;
}

// Throws InputError unless `n` positions can be read, and `answers` written.
void require_places(std::size_t n, const double* positions, const void* answers, const char* name) {
    if (n == 0) return;
    require(positions, "positions");
    require(answers, name);
    const std::size_t wrong =
        first_where(n, [&](std::size_t i) { return point_at(positions, i).array().isNaN().any(); });
    if (wrong < n) throw IndexedError(wrong, fmt::format("position {} is NaN", wrong));
}

// Point and Metric are three and six numbers without gaps (controlspace/space/number_kind.h).
std::span<const Point> points_in(const double* positions, std::size_t begin, std::size_t end) {
    return {reinterpret_cast<const Point*>(positions) + begin, end - begin};
}

// As cspace_size(): meshers call it for every point, so that no reason of a failure is kept.
double size_at(const cspace* handle, const Point& p) noexcept {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (handle == nullptr || !handle->cursor) return none;
    if (std::isnan(p.x()) || std::isnan(p.y()) || std::isnan(p.z())) return none;
    try {
        return handle->cursor->length_at(p);
    } catch (...) {
        return none;
    }
}

// Metric lengths of the edges from a[begin..end) to b[begin..end).
void measure_edges(const ControlSpace& space, std::span<const Point> a, std::span<const Point> b,
                   double* lengths) {
    std::vector<Point> places;
    places.reserve(3 * a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        places.insert(places.end(), {a[i], 0.5 * (a[i] + b[i]), b[i]});
    }
    std::vector<Metric> metrics(places.size());
    space.sample(places, metrics);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Metric* m = &metrics[3 * i];
        lengths[i] = edge_length(a[i], b[i], m[0], m[1], m[2]);
    }
}

// Writes `converted` of each of `n` metrics; what converts to nothing is named by its index.
template <class Converted>
void convert(std::size_t n, const double* from, double* to, Converted&& converted) {
    const std::size_t wrong = first_where(n, [&](std::size_t i) {
        const std::optional<Metric> m = converted(metric_at(from, i));
        if (!m) return true;
        const double numbers[] = {m->xx, m->yy, m->zz, m->xy, m->xz, m->yz};
        std::copy(std::begin(numbers), std::end(numbers), to + 6 * i);
        return false;
    });
    if (wrong < n) {
        throw IndexedError(
            wrong, fmt::format("metric {} is not positive definite: check the order of its numbers",
                               wrong));
    }
}

}  // namespace

cspace_status cspace_sample(const cspace* space, size_t n, const double* positions,
                            double* metrics) {
    return guarded([&] {
        require_places(n, positions, metrics, "metrics");
        const ControlSpace& field = space_of(space);
        in_blocks(n, [&](std::size_t begin, std::size_t end) {
            field.sample(points_in(positions, begin, end),
                         {reinterpret_cast<Metric*>(metrics) + begin, end - begin});
        });
    });
}

cspace_status cspace_sample_lengths(const cspace* space, size_t n, const double* positions,
                                    double* lengths) {
    return guarded([&] {
        require_places(n, positions, lengths, "lengths");
        const ControlSpace& field = space_of(space);
        in_blocks(n, [&](std::size_t begin, std::size_t end) {
            field.sample_lengths(points_in(positions, begin, end), {lengths + begin, end - begin});
        });
    });
}

double cspace_size(const cspace* space, double x, double y, double z) {
    return size_at(space, {x, y, z});
}

double cspace_gmsh_size(int, int, double x, double y, double z, double lc, void* data) {
    const double length = size_at(static_cast<const cspace*>(data), {x, y, z});
    return length < lc || std::isnan(lc) ? length : lc;
}

double cspace_gmsh_size_4_8(int, int, double x, double y, double z, void* data) {
    const double length = size_at(static_cast<const cspace*>(data), {x, y, z});
    return std::isnan(length) ? std::numeric_limits<double>::max() : length;
}

cspace_status cspace_edge_lengths(const cspace* space, size_t n, const double* from,
                                  const double* to, double* lengths) {
    return guarded([&] {
        require_places(n, from, lengths, "lengths");
        require_places(n, to, lengths, "lengths");
        const ControlSpace& field = space_of(space);
        in_blocks(n, [&](std::size_t begin, std::size_t end) {
            constexpr std::size_t few = 512;  // whose metrics stay in the cache
            for (; begin < end; begin += few) {
                const std::size_t last = std::min(begin + few, end);
                measure_edges(field, points_in(from, begin, last), points_in(to, begin, last),
                              lengths + begin);
            }
        });
    });
}

cspace_status cspace_to_riemannian(size_t n, const double* metrics, double* riemannian) {
    return guarded([&] {
        if (n > 0) require(metrics, "metrics");
        if (n > 0) require(riemannian, "riemannian");
        convert(n, metrics, riemannian, [](const Metric& m) {
            return is_source_metric(m) ? std::optional(to_riemannian(m)) : std::nullopt;
        });
    });
}

cspace_status cspace_from_riemannian(size_t n, const double* riemannian, double* metrics) {
    return guarded([&] {
        if (n > 0) require(riemannian, "riemannian");
        if (n > 0) require(metrics, "metrics");
        convert(n, riemannian, metrics, from_riemannian);
    });
}
