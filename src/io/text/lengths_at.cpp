// SPDX-License-Identifier: Apache-2.0
#include "io/text/lengths_at.h"

#include <algorithm>

#include "controlspace/space/sample_parallel.h"
#include "geometry/random_fractions.h"

namespace controlspace {

Lengths lengths_at(const ControlSpace& space, std::span<const Point> places) {
    constexpr std::size_t at_once = 1 << 16;  // metrics are six times as large as lengths
    Lengths lengths;
    lengths.values.reserve(places.size());
    std::vector<Metric> metrics;
    for (std::size_t first = 0; first < places.size(); first += at_once) {
        const auto some = places.subspan(first, std::min(at_once, places.size() - first));
        metrics.resize(some.size());
        sample_parallel(space, some, metrics);
        for (const Metric& m : metrics) {
            const bool is_length = is_isotropic(m);
            lengths.has_tensors = lengths.has_tensors || !is_length;
            lengths.values.push_back(is_length ? m.xx : eigen_frame(m).lengths[0]);
        }
    }
    return lengths;
}

double usual_factor(const ControlSpace& space,
                    const std::function<double(const Point&)>& interpolated) {
    constexpr std::size_t places = 1000, beyond = 10;
    const Box domain = space.domain();
    RandomFractions random(1);
    std::vector<Point> x;
    for (std::size_t i = 0; i < places; ++i) {
        const double a = random(), b = random(), c = random();
        x.push_back(domain.low + Vector(a, b, c).cwiseProduct(domain.edges()));
    }
    std::vector<double> factors = lengths_at(space, x).values;
    for (std::size_t i = 0; i < places; ++i) {
        const double ratio = interpolated(x[i]) / factors[i];
        factors[i] = std::max(ratio, 1 / ratio);
    }
    const auto usual = factors.end() - beyond - 1;
    std::nth_element(factors.begin(), usual, factors.end());
    return *usual;
}

}  // namespace controlspace
