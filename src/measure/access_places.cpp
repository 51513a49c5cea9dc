// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/access_places.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "controlspace/space/sample_parallel.h"
#include "geometry/random_fractions.h"

namespace controlspace {
namespace {

std::size_t index_below(std::size_t n, RandomFractions& fraction) {
    return static_cast<std::size_t>(fraction() * static_cast<double>(n));
}

/// Uniformly from the cube [-1, 1]^3.
Vector in_cube(RandomFractions& fraction) {
    Vector v;
    for (Axis a = 0; a < 3; ++a) v[a] = 2 * fraction() - 1;
    return v;
}

/// Uniformly from the unit ball; never its centre.
Vector in_ball(RandomFractions& fraction) {
    while (true) {
        Vector v = in_cube(fraction);
        if (v.squaredNorm() <= 1 && v != Vector::Zero()) return v;
    }
}

double smallest_length(const Metric& m) {
    return is_isotropic(m) ? m.xx : eigen_frame(m).lengths[0];
}

}  // namespace

std::vector<Point> places_near(const SourceColumns& sources, const Box& domain, std::size_t n,
                               std::uint64_t seed) {
    constexpr double lengths = 2;
    constexpr int most_draws = 64;  // of sources much longer than the domain most are outside
    RandomFractions fraction(seed);
    std::vector<Point> places(n);
    for (Point& p : places) {
        for (int draw = 1;; ++draw) {
            const PointSource source = sources[index_below(sources.size(), fraction)];
            p = source.position + source.metric.matrix() * (lengths * in_ball(fraction));
            for (Axis a = 0; a < 3; ++a) {
                if (domain.low[a] == domain.high[a]) p[a] = domain.low[a];
            }
            if (domain.contains(p)) break;
            p = source.position;
            if (draw == most_draws) break;
        }
    }
    return places;
}

std::vector<Point> places_where_fine(const Probes& probes, int count, const Box& domain,
                                     std::size_t n, std::uint64_t seed) {
    std::vector<double> lengths;
    lengths.reserve(probes.reference.size());
    for (const Metric& m : probes.reference) lengths.push_back(smallest_length(m));
    std::vector<std::size_t> order(lengths.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::size_t fine = (order.size() + 9) / 10;
    std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(fine - 1), {},
                             [&](std::size_t i) { return std::pair(lengths[i], i); });
    order.resize(fine);
    std::ranges::sort(order);  // whatever order nth_element leaves
    const Vector half_cell = domain.edges() / (2 * count);
    RandomFractions fraction(seed);
    std::vector<Point> places(n);
    for (Point& p : places) {
        p = probes.points[order[index_below(fine, fraction)]] +
            half_cell.cwiseProduct(in_cube(fraction));
    }
    return places;
}

std::vector<Point> walks(const ControlSpace& field, const Box& domain,
                         std::span<const Point> starts, std::size_t n, std::uint64_t seed) {
    constexpr std::size_t most_places = 1000;
    constexpr double step = 0.5;
    const std::size_t walkers = (n + most_places - 1) / most_places;
    const std::size_t each = (n + walkers - 1) / walkers;
    RandomFractions fraction(seed);
    std::vector<Point> at(walkers), places(walkers * each);
    for (Point& p : at) p = starts[index_below(starts.size(), fraction)];
    for (std::size_t i = 0; i < each; ++i) {
        const std::vector<Metric> metrics = sample_parallel(field, at);
        for (std::size_t w = 0; w < walkers; ++w) {
            places[w * each + i] = at[w];
            const Vector way = in_ball(fraction).normalized();
            at[w] = nearest_in(domain, at[w] + step * (metrics[w].matrix() * way));
        }
    }
    places.resize(n);
    return places;
}

}  // namespace controlspace
