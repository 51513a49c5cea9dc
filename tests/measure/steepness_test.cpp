// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/steepness.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <limits>

#include "controlspace/measure/access_time.h"
#include "controlspace/measure/reference.h"
#include "measure/fake_spaces.h"
#include "metric/draw.h"

namespace controlspace::steepness_test {
namespace {

const Box cube{Point(-1, -1, -1), Point(1, 1, 1)};

Steepness steepness_of(FunctionSpace::Function f, std::span<const PointSource> sources = {}) {
    return steepness(FunctionSpace(std::move(f)), cube, sources, 7);
}

std::vector<PointSource> draw_sources(double anisotropy) {
    Draw draw(5);
    std::vector<PointSource> sources;
    for (const Point& x : random_points(cube, 60, 3)) {
        sources.push_back({x, draw.metric(draw.uniform(0.02, 0.1), anisotropy)});
    }
    return sources;
}

}  // namespace

TEST_CASE("A constant field has no steepness") {
    const Metric m{0.3, 0.2, 0.5, 0.01, -0.02, 0.03};
    const Steepness s = steepness_of([&](const Point&) { return m; });
    CHECK(s.det == 1);
    CHECK(s.dir == 1);
}

TEST_CASE("The steepness of lengths that grow by a per unit of distance is 1 + a") {
    const auto lengths = GENERATE(Metric::isotropic(1), Metric{0.5, 3, 2, 0, 0, 0});
    const double a = 0.3;  // along x, where the metric's length is 1 or 1/2
    const Steepness s =
        steepness_of([&](const Point& x) { return (0.4 + a * (x.x() + 1)) * lengths; });
    for (const double g : {s.det, s.dir}) {
        CHECK(g <= 1 + lengths.xx * a + 1e-9);
        CHECK(g > 1 + 0.995 * lengths.xx * a);
    }
}

TEST_CASE("A single length that grows counts by a third for elements, whole for lengths") {
    const double a = 0.5;
    const Steepness s = steepness_of(
        [&](const Point& x) { return 0.1 * Metric{1, 20 + a * 10 * (x.x() + 1), 1, 0, 0, 0}; });
    // Steepest at x = -1, towards greater x.
    const double steepest = 0.1 * a * 10 / 20;
    CHECK(s.dir <= 1 + steepest);
    CHECK(s.dir > 1 + 0.98 * steepest);
    CHECK(s.det <= 1 + steepest / 3);
    CHECK(s.det > 1 + 0.98 * steepest / 3);
}

TEST_CASE("A jump is as steep as the nearest pair across it shows") {
    const double jump = 0.5;
    const Steepness s = steepness_of(
        [&](const Point& x) { return Metric::isotropic(x.x() < 0.1 ? 0.1 : (1 + jump) * 0.1); });
    for (const double g : {s.det, s.dir}) {
        CHECK(g <= 1 + jump / shortest_pair);
        CHECK(g > 1 + 0.4 * jump / shortest_pair);
    }
}

TEST_CASE("Steepness is sampled near sources too") {
    const std::vector<PointSource> sources{{Point(0.3, 0.2, -0.1), Metric::isotropic(1e-4)}};
    const auto pit = [&](const Point& x) {
        return Metric::isotropic((x - sources[0].position).norm() < 3e-4 ? 1e-4 : 3e-4);
    };
    CHECK(steepness_of(pit).det == 1);
    CHECK(steepness_of(pit, sources).det > 10);
}

TEST_CASE("The exact field is as steep as the gradation ratio, its elements no steeper") {
    const double g = 1.25;
    const double anisotropy = GENERATE(1.0, 4.0, 50.0);
    const std::vector<PointSource> sources = draw_sources(anisotropy);
    const auto field =
        exact_reference(sources, g, Metric::isotropic(1), 0, IntersectionRule::order_free);
    const Steepness s = steepness(*field, cube, sources, 7, anisotropy == 1 ? 4000 : 1000);
    // Lengths are known to 1e-6 at distances of 0.01.
    CHECK(s.det < g + 1e-4);
    if (anisotropy == 1) {
        CHECK(s.dir < g + 1e-4);
        // Away from sources isotropic lengths grow by g - 1 everywhere: any pair along it shows it.
        CHECK(s.det > 1 + 0.995 * (g - 1));
    }
}

TEST_CASE("What is no metric is infinitely steep") {
    const Steepness s =
        steepness_of([](const Point& x) { return Metric::isotropic(x.x() < 0.9 ? 0.1 : -0.1); });
    CHECK(s.det == std::numeric_limits<double>::infinity());
    CHECK(s.dir == std::numeric_limits<double>::infinity());
}

TEST_CASE("Steepness depends on its seed, and not on threads", "[threads]") {
    const auto field = [](const Point& x) {
        return Metric{0.1 + 0.05 * std::sin(9 * x.x()), 0.3, 0.2, 0.01 * x.y(), 0, 0};
    };
    const FunctionSpace space(field);
    const auto with = [&](std::uint64_t seed) { return steepness(space, cube, {}, seed).dir; };
    const double found = with(7);
    CHECK(with(8) != found);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(with(7) == found);
}

}  // namespace controlspace::steepness_test
