// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/surface_fields.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "fields/values.h"
#include "metric/draw.h"

namespace controlspace::surface_fields_test {

using Catch::Matchers::Contains;

namespace {

constexpr SurfaceLengths thin{.across = 0.002, .along = 0.1, .growth = 0.5, .largest = 0.2};

}  // namespace

TEST_CASE("the isotropic field of a sphere is its closed form") {
    const auto sphere =
        sphere_field({.centre = {1, 2, 3}, .radius = 0.5, .lengths = {0.03, 0.03, 0.25, 0.2}});
    CHECK(sphere.finest_length == 0.03);
    const auto& field = *sphere.field;
    CHECK(value_at(field, {1.5, 2, 3}) == Metric::isotropic(0.03));
    CHECK(value_at(field, {1, 2, 3}) == Metric::isotropic(0.03 + 0.25 * 0.5));
    CHECK(value_at(field, {1, 2, 3.75}) == Metric::isotropic(0.03 + 0.25 * 0.25));
    CHECK(value_at(field, {1, -20, 3}) == Metric::isotropic(0.2));
}

TEST_CASE("the field of a sphere has its lengths across and along") {
    const Point centre(0.25, -0.5, 1);
    const auto sphere = sphere_field({.centre = centre, .radius = 0.5, .lengths = thin});
    CHECK(sphere.finest_length == 0.002);
    Draw draw(1);
    for (int i = 0; i < 200; ++i) {
        const Vector n = draw.vector().normalized();
        const double d = draw.uniform(0, 0.25);
        for (const double r : {0.5 - d, 0.5 + d}) {
            const Metric m = value_at(*sphere.field, centre + r * n);
            CHECK((m.matrix() * n - std::min(0.2, 0.002 + 0.5 * d) * n).norm() < 1e-14);
            const Vector t = n.unitOrthogonal();
            CHECK((m.matrix() * t - std::min(0.2, 0.1 + 0.5 * d) * t).norm() < 1e-14);
        }
    }
    const Metric at_centre = value_at(*sphere.field, centre);
    CHECK(is_positive_definite(at_centre));
}

TEST_CASE("the field of a sphere turns with it") {
    const auto sphere = sphere_field({.lengths = thin});
    Draw draw(2);
    for (int i = 0; i < 100; ++i) {
        const Eigen::Matrix3d r = draw.rotation();
        const Point p = draw.vector();
        const Metric turned = rotated(value_at(*sphere.field, p), r);
        CHECK(difference(value_at(*sphere.field, r * p), turned) < 1e-13);
    }
}

TEST_CASE("fields on their surfaces are what sampled sources ask for") {
    const SurfaceLengths lengths{.across = 0.015, .along = 0.06};
    const auto sphere = sphere_field({.lengths = lengths});
    for (const auto& [p, m, growth] : sample_sphere({.s_a = 4, .s_n = 0.25, .rho = 8})) {
        CHECK(difference(value_at(*sphere.field, p), m) < 1e-13);
    }
    const auto planes = planes_field({.slope = 0.75, .lengths = lengths});
    for (const auto& [p, m, growth] :
         sample_planes({.s_a = 4, .s_n = 0.25, .rho = 8, .slope = 0.75})) {
        // Near where they cross, the other plane asks for less.
        const Metric value = value_at(*planes.field, p);
        CHECK(is_within(value, 1 + 1e-12, m));
        const bool lone = m.yy > 0.05 ? std::abs(-0.2 + 0.75 * p.x() - p.y()) / 1.25 > 0.3
                                      : std::abs(p.x() + 0.5) > 0.3;
        if (lone) CHECK(difference(value, m) < 1e-13);
    }
}

TEST_CASE("the isotropic field of planes goes by the nearest one") {
    const auto planes = planes_field({.slope = -0.5, .lengths = {0.01, 0.01, 0.3, 0.15}});
    Draw draw(3);
    for (int i = 0; i < 300; ++i) {
        const Point p(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const double second = std::abs(-0.5 * p.x() - 0.2 - p.y()) / std::sqrt(1.25);
        const double h = std::min(0.15, 0.01 + 0.3 * std::min(std::abs(p.x() + 0.5), second));
        const Metric m = value_at(*planes.field, p);
        CHECK(is_isotropic(m));
        CHECK(m.xx == Approx(h).epsilon(1e-13));
    }
}

TEST_CASE("surface fields refuse what they cannot do") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {0.0, -0.5, nan, std::numeric_limits<double>::infinity()}) {
        CHECK_THROWS_AS(sphere_field({.radius = bad}), InputError);
        CHECK_THROWS_AS(sphere_field({.lengths = {.across = bad}}), InputError);
        CHECK_THROWS_AS(planes_field({.lengths = {.along = bad}}), InputError);
        CHECK_THROWS_AS(sphere_field({.lengths = {.largest = bad}}), InputError);
        if (bad != 0) CHECK_THROWS_AS(planes_field({.lengths = {.growth = bad}}), InputError);
    }
    CHECK_NOTHROW(sphere_field({.lengths = {.growth = 0}}));
    CHECK_THROWS_WITH(sphere_field({.centre = {nan, 0, 0}}),
                      Contains("centre of a field = (nan, 0, 0)"));
    CHECK_THROWS_WITH(planes_field({.slope = nan}), Contains("slope nan"));
}

}  // namespace controlspace::surface_fields_test
