// SPDX-License-Identifier: Apache-2.0
#include "mesh/size_query.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "refuse.h"

namespace controlspace {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t nanoseconds_between(Clock::time_point a, Clock::time_point b) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(b - a).count();
}

/// Of reading it once.
std::int64_t cost_of_clock() {
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < 1000; ++i) {
        const auto start = Clock::now();
        least = std::min(least, nanoseconds_between(start, Clock::now()));
    }
    return least;
}

}  // namespace

void require_metric(const Metric& m, const Point& p) {
    if (is_positive_definite(m)) return;
    refuse("the field at ({}, {}, {}) is no metric: {}", p.x(), p.y(), p.z(), to_string(m));
}

SizeQuery::SizeQuery(const ControlSpace& field, const UnitFrame& frame, double factor)
    : field_(field), frame_(frame), factor_(factor), clock_cost_(cost_of_clock()) {}

double SizeQuery::operator()(double x, double y, double z) noexcept {
    if (failed_) return 1;
    // Reading the clock takes as long as a query: few are timed.
    constexpr std::size_t timed_one_in = 16;
    if (count_++ % timed_one_in != 0) return scaled_length(x, y, z);
    const auto start = Clock::now();
    const double h = scaled_length(x, y, z);
    const std::int64_t elapsed = nanoseconds_between(start, Clock::now());
    // Far longer than any query: the system gave the processor to another program meanwhile.
    constexpr std::int64_t interrupted = 1'000'000;
    if (elapsed < interrupted) nanoseconds_ += timed_one_in * (elapsed - clock_cost_);
    return h;
}

void SizeQuery::rethrow_failure() const {
    if (failed_) std::rethrow_exception(failure_);
}

double SizeQuery::scaled_length(double x, double y, double z) noexcept {
    try {
        return factor_ * smallest_length(frame_.to_domain(x, y, z)) / frame_.scale;
    } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failed_) failure_ = std::current_exception();
        failed_ = true;
    }
    return 1;
}

double SizeQuery::smallest_length(const Point& p) {
    const Metric m = field_.metric_at(p);
    require_metric(m, p);
    if (is_isotropic(m)) return m.xx;
    const auto lengths = eigen_frame(m).lengths;
    if (lengths_differ(lengths)) anisotropic_ = true;
    return lengths[0];
}

}  // namespace controlspace
