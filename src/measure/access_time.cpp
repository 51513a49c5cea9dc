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

double duration_s(const ControlSpace& space, std::span<const Point> points,
                  std::span<Metric> answers, Calls calls) {
    const Stopwatch time;
    if (calls == Calls::one) {
        space.sample(points, answers);
    } else {
        for (std::size_t i = 0; i < points.size(); ++i) answers[i] = space.metric_at(points[i]);
    }
    return time.seconds();
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
    // Every step is a bijection of the sum so far, so that one changed bit always shows; the shift
    // brings high bits down, which multiplication alone would never do.
    std::uint64_t sum = 0xcbf29ce484222325;
    for (const Metric& m : metrics) {
        for (const double number : {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz}) {
            sum = (sum ^ std::bit_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15;
            sum ^= sum >> 32;
        }
    }
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
                                     std::span<const Point> points, int repeats, Calls calls,
                                     double shortest_s) {
    if (points.empty()) refuse("access time at no places: give at least one point");
    if (repeats < 1) refuse("{} timed repeats: give at least one", repeats);

    std::vector<Metric> answers(points.size());
    std::vector<AccessTime> results(spaces.size());
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (std::size_t i = 0; i < spaces.size(); ++i) {
            AccessTime& result = results[i];
            const auto require_same = [&] {
                if (checksum(answers) == result.checksum) return;
                throw std::logic_error("a structure does not answer as it did the first time");
            };
            spaces[i]->sample(points, answers);
            if (repeat == 0) result.checksum = checksum(answers);
            require_same();
            double seconds = 0;
            std::uint64_t runs = 0;
            do {
                seconds += duration_s(*spaces[i], points, answers, calls);
                ++runs;
                require_same();
            } while (seconds < shortest_s);
            result.samples_ns.push_back(
                seconds * 1e9 / (static_cast<double>(runs) * static_cast<double>(points.size())));
        }
    }
    return results;
}

AccessTime access_time(const ControlSpace& space, std::span<const Point> points, int repeats,
                       double shortest_s) {
    const ControlSpace* const one[] = {&space};
    return std::move(access_times(one, points, repeats, Calls::one, shortest_s).front());
}

}  // namespace controlspace
