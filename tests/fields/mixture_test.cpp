// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/mixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <span>

#include "controlspace/error.h"
#include "controlspace/fields/surface_fields.h"
#include "controlspace/fields/ugawg_fields.h"
#include "controlspace/metric/intersection.h"
#include "fields/values.h"
#include "metric/draw.h"

namespace controlspace::mixture_test {

TEST_CASE("a mixture is the intersection of its fields, in their order") {
    const auto polar = ugawg_polar_2().field;
    const auto sphere = sphere_field({.centre = Point::Constant(0.4),
                                      .radius = 0.3,
                                      .lengths = {.across = 0.003, .along = 0.05}})
                            .field;
    const auto linear = ugawg_linear().field;
    const auto mixed = mixture({polar, sphere, linear});
    Draw draw(5);
    for (int i = 0; i < 300; ++i) {
        const Point p(draw.uniform(0, 1), draw.uniform(0, 1), draw.uniform(0, 1));
        const Metric m = value_at(*mixed, p);
        CHECK(m == intersection(intersection(value_at(*polar, p), value_at(*sphere, p)),
                                value_at(*linear, p)));
        for (const auto& field : {polar, sphere, linear}) {
            CHECK(is_within(m, 1 + 1e-9, value_at(*field, p)));
        }
    }
}

TEST_CASE("a mixture with itself, or with one that never matters, is the field") {
    const auto polar = ugawg_polar_1().field;
    const auto wide = function_field([](const Point&) { return Metric::isotropic(1); }, 1).field;
    Draw draw(6);
    for (int i = 0; i < 100; ++i) {
        const Point p(draw.uniform(0, 1), draw.uniform(0, 1), draw.uniform(0, 1));
        CHECK(value_at(*mixture({polar, polar}), p) == value_at(*polar, p));
        CHECK(value_at(*mixture({polar, wide}), p) == value_at(*polar, p));
        CHECK(value_at(*mixture({wide, polar}), p) == value_at(*polar, p));
    }
}

TEST_CASE("a mixture needs a field") { CHECK_THROWS_AS(mixture({}), InputError); }

TEST_CASE("a mixture is defined where all its fields are") {
    struct Within final : ControlSpace {
        explicit Within(const Box& where) : box(where) {}
        void sample(std::span<const Point>, std::span<Metric> out) const override {
            std::ranges::fill(out, Metric::isotropic(1));
        }
        Box domain() const override { return box; }
        Box box;
    };
    const auto field = [](const Point& low, const Point& high) {
        return std::make_shared<Within>(Box{low, high});
    };
    const auto mixed = mixture({field({0, -1, 2}, {4, 3, 9}), field({1, -2, 5}, {6, 2, 8})});
    CHECK(mixed->domain().low == Point(1, -1, 5));
    CHECK(mixed->domain().high == Point(4, 2, 8));
}

}  // namespace controlspace::mixture_test
