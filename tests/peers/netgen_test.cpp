// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "controlspace/input_errors.h"
#include "peers/peers.h"

namespace controlspace::netgen_test {

TEST_CASE("Netgen's sizes at a source keep to its dead band of 20 %") {
    const Work work = GENERATE(oblong_box(), isotropic_sphere());
    const double ratio = GENERATE(1.1, 1.5);
    CAPTURE(work.name, ratio);
    const auto lengths = lengths_at(*finished("netgen-localh", work, ratio), places_in(work, 0));
    for (std::size_t i = 0; i < work.sources.size(); ++i) {
        REQUIRE(lengths[i] <= 1.2 * work.sources[i].metric.xx * (1 + 1e-6));
    }
}

TEST_CASE("a source within Netgen's dead band changes nothing") {
    Work work = oblong_box();
    work.sources.resize(1);
    const auto places = places_in(work);
    const auto one = lengths_at(*finished("netgen-localh", work), places);
    const auto again = [&](double factor) {
        Work second = work;
        second.sources.push_back(work.sources[0]);
        second.sources[1].metric = factor * work.sources[0].metric;
        return lengths_at(*finished("netgen-localh", second), places);
    };
    CHECK(differing(again(1), one) == 0);
    CHECK(differing(again(0.84), one) == 0);
    CHECK(differing(again(0.82), one) > 0);
}

TEST_CASE("the exact field at Netgen's boxes errs by their size alone") {
    const Work work = GENERATE(oblong_box(), isotropic_sphere());
    constexpr double ratio = 1.25;
    const auto sources = places_in(work, 0);
    const auto lengths = lengths_at(*finished("netgen-localh-exact", work, ratio), sources);
    const auto exact = lengths_at(*finished("direct", work, ratio), sources);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        // The box of a source is a cube with edges of at most 1.2 of its length.
        const double way = 0.5 * std::sqrt(3.0) * 1.2 * work.sources[i].metric.xx;
        REQUIRE(std::abs(lengths[i] - exact[i]) <= (ratio - 1) * way * (1 + 1e-6));
    }
}

TEST_CASE("Netgen's own law departs from the exact field more than its octree does") {
    const Work work = oblong_box();
    const auto places = places_in(work);
    const auto exact = lengths_at(*finished("direct", work), places);
    const auto mean_departure = [&](const char* id) {
        const auto lengths = lengths_at(*finished(id, work), places);
        double sum = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            sum += std::abs(std::log(lengths[i] / exact[i]));
        }
        return sum / static_cast<double>(places.size());
    };
    const double own = mean_departure("netgen-localh");
    const double stored = mean_departure("netgen-localh-exact");
    CAPTURE(own, stored);
    CHECK(own > 2 * stored);
}

TEST_CASE("Netgen's boxes of a plane across z are those of a quadtree") {
    const Work across_y = flat_box();
    Work across_z = across_y;
    const auto turn = [](Point& p) { std::swap(p.y(), p.z()); };
    turn(across_z.domain.low);
    turn(across_z.domain.high);
    for (PointSource& source : across_z.sources) turn(source.position);
    const auto cells = [](const Work& work) {
        return finished("netgen-localh", work)->footprint().cells;
    };
    CHECK(2 * cells(across_z) < cells(across_y));
}

TEST_CASE("Netgen's sizes refuse tensors") {
    Work work = oblong_box();
    work.sources[2].metric.xx *= 2;
    const auto builder = row_named("netgen-localh").make(work.options());
    CHECK_THROWS_WITH(builder->insert(work.sources), Catch::Contains("source 2: "));
}

}  // namespace controlspace::netgen_test
