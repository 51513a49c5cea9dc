// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/analytic_field.h"

#include <catch2/catch.hpp>
#include <vector>

#include "controlspace/error.h"
#include "fields/values.h"

namespace controlspace::analytic_field_test {

using Catch::Matchers::Contains;

TEST_CASE("a function field answers its function, in the order of the places") {
    const auto field =
        function_field([](const Point& p) { return Metric::isotropic(1 + p.x()); }, 1);
    CHECK(field.finest_length == 1);
    std::vector<Point> points;
    for (int i = 0; i < 1000; ++i) points.emplace_back(i, 0, 0);
    std::vector<Metric> metrics(points.size());
    field.field->sample(points, metrics);
    for (int i = 0; i < 1000; ++i) {
        REQUIRE(metrics[static_cast<std::size_t>(i)] == Metric::isotropic(1 + i));
    }
}

TEST_CASE("a function that answers no metric is named with the place") {
    const auto field = function_field([](const Point& p) { return Metric::isotropic(p.x()); }, 1);
    CHECK(value_at(*field.field, {2, 0, 0}) == Metric::isotropic(2));
    CHECK_THROWS_WITH(value_at(*field.field, {-2, 0, 1}),
                      Contains("(-2, 0, 1)") && Contains("not positive definite"));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(value_at(*field.field, {nan, 0, 0}), InputError);
    for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        CHECK_THROWS_AS(function_field([](const Point&) { return Metric{}; }, bad), InputError);
    }
}

TEST_CASE("a domain must lie in the field's definition") {
    const auto one = [](const Point&) { return Metric{}; };
    const auto unbounded = function_field(one, 1);
    const auto bounded = function_field(one, 1, {Point::Zero(), Point::Ones()});
    const Box inside{Point::Constant(0.25), Point::Ones()};
    const Box beyond{Point::Constant(0.25), Point(1, 1, 1.5)};
    CHECK_NOTHROW(require_defined(unbounded, beyond, "f"));
    CHECK_NOTHROW(require_defined(bounded, inside, "f"));
    CHECK_THROWS_WITH(require_defined(bounded, beyond, "f"),
                      Contains("field f") && Contains("[0, 1] x [0, 1] x [0, 1]"));
}

}  // namespace controlspace::analytic_field_test
