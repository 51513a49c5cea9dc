// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/access_time.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "geometry/random_fractions.h"
#include "measure/stopwatch.h"
#include "refuse.h"

namespace controlspace {

namespace {

void answer_all(const ControlSpace& space, std::span<const Point> x, std::span<Metric> out) {
    space.sample(x, out);
}
void answer_all(const ControlSpace& space, std::span<const Point> x, std::span<double> out) {
    space.sample_lengths(x, out);
}

/// `from`: a structure or a cursor.
void answer_each(auto& from, std::span<const Point> x, std::span<Metric> out) {
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = from.metric_at(x[i]);
}
void answer_each(auto& from, std::span<const Point> x, std::span<double> out) {
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = from.length_at(x[i]);
}

template <class Answer>
double duration_s(const ControlSpace& space, std::span<const Point> points,
                  std::span<Answer> answers, Calls calls) {
    const auto cursor = calls == Calls::cursor ? space.cursor() : nullptr;
    const Stopwatch time;
    switch (calls) {
        case Calls::one:
            answer_all(space, points, answers);
            break;
        case Calls::each:
            answer_each(space, points, answers);
            break;
        case Calls::cursor:
            answer_each(*cursor, points, answers);
            break;
    }
    return time.seconds();
}

/// Every step is a bijection of the sum so far, so that one changed bit always shows; the shift
/// brings high bits down, which multiplication alone would never do.
void add(std::uint64_t& sum, double number) {
    sum = (sum ^ std::bit_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15;
    sum ^= sum >> 32;
}
constexpr std::uint64_t empty_sum = 0xcbf29ce484222325;

void require_of_metrics(const ControlSpace&, std::span<const Point>, std::span<const Metric>) {}
void require_of_metrics(const ControlSpace& space, std::span<const Point> x,
                        std::span<const double> lengths) {
    constexpr double rounding = 1e-9;
    std::vector<double> expected(x.size());
    space.ControlSpace::sample_lengths(x, expected);  // by its metrics
    if (std::ranges::equal(lengths, expected, [](double a, double b) {
            return std::abs(a - b) <= rounding * std::abs(b) || std::isnan(b);
        })) {
        return;
    }
    throw std::logic_error("a structure's lengths are not those of its metrics");
}

template <class Answer>
std::vector<AccessTime> times_of(std::span<const ControlSpace* const> spaces,
                                 std::span<const Point> points, int repeats, Calls calls,
                                 double shortest_s, double most_s) {
    std::vector<Answer> answers(points.size());
    const auto sum = [&] { return checksum(std::span<const Answer>(answers)); };
    std::vector<AccessTime> results(spaces.size());
    std::vector<double> taken(spaces.size(), 0);
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (std::size_t i = 0; i < spaces.size(); ++i) {
            if (taken[i] > most_s) continue;
            const Stopwatch time;
            AccessTime& result = results[i];
            const auto require_same = [&] {
                if (sum() == result.checksum) return;
                throw std::logic_error("a structure does not answer as it did the first time");
            };
            answer_all(*spaces[i], points, answers);
            if (repeat == 0) {
                result.checksum = sum();
                require_of_metrics(*spaces[i], points, answers);
            }
            require_same();
            double seconds = 0;
            std::uint64_t runs = 0;
            do {
                seconds += duration_s<Answer>(*spaces[i], points, answers, calls);
                ++runs;
                require_same();
            } while (seconds < shortest_s);
            result.samples_ns.push_back(
                seconds * 1e9 / (static_cast<double>(runs) * static_cast<double>(points.size())));
            taken[i] += time.seconds();
        }
    }
    return results;
}

}  // namespace

std::vector<Point> random_points(const Box& box, std::size_t n, std::uint64_t seed) {
    constexpr std::size_t most = std::size_t{1} << 28;
    if (n > most) refuse("{} random points: give at most {}", n, most);
    RandomFractions fraction(seed);
    std::vector<Point> points(n);
    for (Point& p : points) {
        for (Axis a = 0; a < 3; ++a) p[a] = box.low[a] + fraction() * (box.high[a] - box.low[a]);
    }
    return points;
}

std::uint64_t checksum(std::span<const Metric> metrics) {
    std::uint64_t sum = empty_sum;
    for (const Metric& m : metrics) {
        for (const double number : {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz}) add(sum, number);
    }
    return sum;
}

std::uint64_t checksum(std::span<const double> lengths) {
    std::uint64_t sum = empty_sum;
    for (const double length : lengths) add(sum, length);
    return sum;
}

double quartile(std::vector<double> samples, int number) {
    if (number < 1 || number > 3) refuse("quartile {}: there are 1, 2 and 3", number);
    if (samples.empty()) refuse("a quartile of no samples: time at least one repeat");
    std::sort(samples.begin(), samples.end());
    const double rank = 0.25 * number * static_cast<double>(samples.size() - 1);
    const auto below = static_cast<std::size_t>(rank);
    const std::size_t above = std::min(below + 1, samples.size() - 1);
    return std::lerp(samples[below], samples[above], rank - std::floor(rank));
}

std::vector<AccessTime> access_times(std::span<const ControlSpace* const> spaces,
                                     std::span<const Point> points, int repeats, AccessQuery query,
                                     double shortest_s, double most_s) {
    if (points.empty()) refuse("access time at no places: give at least one point");
    if (repeats < 1) refuse("{} timed repeats: give at least one", repeats);
    return query.answers == Answers::lengths
               ? times_of<double>(spaces, points, repeats, query.calls, shortest_s, most_s)
               : times_of<Metric>(spaces, points, repeats, query.calls, shortest_s, most_s);
}

AccessTime access_time(const ControlSpace& space, std::span<const Point> points, int repeats,
                       double shortest_s) {
    const ControlSpace* const one[] = {&space};
    return std::move(access_times(one, points, repeats, {}, shortest_s).front());
}

}  // namespace controlspace
