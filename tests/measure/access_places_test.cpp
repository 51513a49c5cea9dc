// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/access_places.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "controlspace/geometry/extent.h"
#include "measure/fake_spaces.h"

namespace controlspace::access_places_test {
namespace {

const Box box{Point(-1, 0, 10), Point(1, 5, 10.5)};
constexpr std::size_t n = 20000;

SourceColumns some_sources() {
    return columns_of(std::vector<PointSource>{
        {Point(0, 1, 10.2), Metric::isotropic(0.05)},
        {Point(0, 4, 10.2),
         metric_from_frame(
             {0.01, 0.04, 0.09},
             Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()).toRotationMatrix())},
        {Point(1, 5, 10.5), Metric::isotropic(0.1)}});
}

}  // namespace

TEST_CASE("Places near sources fill the ellipsoids of two of their lengths, within the domain") {
    const SourceColumns sources = some_sources();
    const auto places = places_near(sources, box, n, 1);
    REQUIRE(places.size() == n);
    std::array<int, 3> near{}, within_half{};
    for (const Point& p : places) {
        REQUIRE(box.contains(p));
        bool is_near = false;
        for (std::size_t i = 0; i < 3; ++i) {
            const double d = metric_length(sources[i].metric, p - sources[i].position);
            if (d > 2 + 1e-9) continue;
            is_near = true;
            ++near[i];
            within_half[i] += d <= 1 ? 1 : 0;
        }
        REQUIRE(is_near);
    }
    // Of a source in a corner an eighth of the draws is kept.
    const double all = 2 + 0.125;
    CHECK(near[0] == Approx(n / all).epsilon(0.05));
    CHECK(near[1] == Approx(n / all).epsilon(0.05));
    CHECK(near[2] == Approx(0.125 * n / all).epsilon(0.1));
    // An eighth of the volume of a ball of radius 2 is within 1.
    for (std::size_t i = 0; i < 2; ++i) CHECK(within_half[i] == Approx(near[i] / 8.0).epsilon(0.1));
    CHECK(places_near(sources, box, n, 1) == places);
    CHECK(places_near(sources, box, n, 2) != places);
}

TEST_CASE("In a flat domain, and of sources longer than the domain, places are in it") {
    const Box flat{Point(0, 0, 3), Point(1, 1, 3)};
    const auto short_one =
        columns_of(std::vector<PointSource>{{Point(0.5, 0.5, 3), Metric::isotropic(0.1)}});
    for (const Point& p : places_near(short_one, flat, 100, 1)) REQUIRE(flat.contains(p));
    const auto long_one =
        columns_of(std::vector<PointSource>{{Point(0, 0, 10), Metric::isotropic(1e6)}});
    for (const Point& p : places_near(long_one, box, 100, 1)) REQUIRE(box.contains(p));
    const FunctionSpace field([](const Point&) { return Metric::isotropic(0.2); });
    for (const Point& p : walks(field, flat, std::vector{Point(0, 0, 3)}, 100, 1)) {
        REQUIRE(flat.contains(p));
    }
}

TEST_CASE("Without sources, places are where a tenth of the probes has the smallest lengths") {
    constexpr int count = 20;
    const FunctionSpace field([](const Point& p) { return Metric::isotropic(1 + p.y()); });
    const Probes probes = make_probes(field, cell_centres(box, count));
    const auto places = places_where_fine(probes, count, box, n, 1);
    double sum = 0;
    for (const Point& p : places) {
        REQUIRE(box.contains(p));
        REQUIRE(p.y() <= 0.5 * (1 + 1e-12));
        sum += p.y();
    }
    CHECK(sum / n == Approx(0.25).epsilon(0.05));
    CHECK(places_where_fine(probes, count, box, n, 1) == places);
}

TEST_CASE("Walks take steps of half a length from their starts, within the domain") {
    const Metric m = metric_from_frame({0.02, 0.05, 0.1}, Eigen::Matrix3d::Identity());
    const FunctionSpace field([&](const Point& p) { return p.y() < 2 ? m : 2 * m; });
    const std::vector<Point> starts{Point(0, 1, 10.2), Point(0, 4, 10.2)};
    const std::size_t many = GENERATE(1, 999, 1001, 2500);
    const auto places = walks(field, box, starts, many, 1);
    REQUIRE(places.size() == many);
    std::size_t begun = 0, whole = 0;
    for (std::size_t i = 0; i < many; ++i) {
        REQUIRE(box.contains(places[i]));
        if (std::ranges::count(starts, places[i]) > 0) {
            ++begun;
            continue;
        }
        const double step =
            metric_length(sample_at(field, places[i - 1]), places[i] - places[i - 1]);
        REQUIRE(step <= 0.5 + 1e-9);
        whole += step > 0.5 - 1e-9 ? 1 : 0;
    }
    CHECK(begun == (many + 999) / 1000);
    CHECK(5 * whole >= 4 * (many - begun));  // others end at a face
    CHECK(walks(field, box, starts, many, 1) == places);
}

}  // namespace controlspace::access_places_test
