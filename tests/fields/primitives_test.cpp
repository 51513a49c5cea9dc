// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/primitives.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "controlspace/error.h"
#include "fields/values.h"
#include "metric/draw.h"

namespace controlspace::primitives_test {

using Catch::Matchers::Contains;

namespace {

double distance(const std::string& text, const Point& x) {
    return distance_from(parse_primitive(text)).distance(x);
}

double length_at(const std::vector<std::string>& texts, const Point& x, double ratio = 1.25) {
    std::vector<Primitive> primitives;
    std::vector<DistanceField> distances;
    for (const std::string& text : texts) {
        primitives.push_back(parse_primitive(text));
        distances.push_back(distance_from(primitives.back()));
    }
    const Metric m = value_at(*primitives_field(primitives, std::move(distances), ratio).field, x);
    CHECK(m == Metric::isotropic(m.xx));
    return m.xx;
}

std::string error_of(const std::string& text) {
    try {
        parse_primitive(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// A point of the primitive; t in [0, 1]^3.
Point point_in(const Primitive& p, const Vector& t) {
    const Vector around = (p.b - p.a).unitOrthogonal();
    const Vector beside = (p.b - p.a).normalized().cross(around);
    const double angle = 2 * M_PI * t.y(), r = p.radius * std::sqrt(t.z());
    switch (p.shape) {
        case Shape::box:
            return p.a + t.cwiseProduct(p.b - p.a);
        case Shape::ball: {
            const double z = 2 * t.x() - 1, s = std::sqrt(1 - z * z);
            const Vector n(s * std::cos(angle), s * std::sin(angle), z);
            return p.a + p.radius * std::cbrt(t.z()) * n;
        }
        default:
            return p.a + t.x() * (p.b - p.a) +
                   r * (std::cos(angle) * around + std::sin(angle) * beside);
    }
}

}  // namespace

TEST_CASE("distances from primitives are the closed forms") {
    CHECK(distance("ball:1,2,3,r=0.5,h=1", {1, 2, 5}) == 1.5);
    CHECK(distance("ball:1,2,3,r=0.5,h=1", {1.2, 2.1, 3.2}) == 0);
    CHECK(distance("box:0,1,0,2,0,3,h=1", {0.5, 1, 2.9}) == 0);
    CHECK(distance("box:0,1,0,2,0,3,h=1", {4, 6, 3}) == 5);
    CHECK(distance("box:0,1,0,2,0,3,h=1", {-2, -3, -6}) == 7);
    CHECK(distance("segment:0,0,0,2,0,0,h=1", {1, 3, 4}) == 5);
    CHECK(distance("segment:0,0,0,2,0,0,h=1", {6, 3, 0}) == 5);
    CHECK(distance("cylinder:0,0,0,0,0,2,r=1,h=1", {0.5, 0.5, 1.9}) == 0);
    CHECK(distance("cylinder:0,0,0,0,0,2,r=1,h=1", {3, 0, 1}) == 2);
    CHECK(distance("cylinder:0,0,0,0,0,2,r=1,h=1", {0.5, 0, -3}) == 3);
    CHECK(distance("cylinder:0,0,0,0,0,2,r=1,h=1", {0, 4, 6}) == 5);  // from the rim
}

TEST_CASE("distances are the smallest to any point of a primitive, within its box") {
    const std::string text = GENERATE(
        "box:-0.5,0.25,0,0.5,-0.1,0.2,h=1", "ball:0.1,-0.2,0.3,r=0.4,h=1",
        "cylinder:-0.3,0.1,0,0.4,0.5,-0.2,r=0.25,h=1", "segment:-0.3,0.1,0,0.4,0.5,-0.2,h=1");
    const Primitive p = parse_primitive(text);
    const DistanceField field = distance_from(p);
    Draw draw(1);
    const auto fraction = [&] { return draw.uniform(0, 1); };
    Box seen{Point::Constant(1e9), Point::Constant(-1e9)};
    std::vector<Point> inside;
    for (int i = 0; i < 20000; ++i) {
        inside.push_back(point_in(p, {fraction(), fraction(), fraction()}));
        CHECK(field.distance(inside.back()) < 1e-12);
        seen.low = seen.low.cwiseMin(inside.back());
        seen.high = seen.high.cwiseMax(inside.back());
    }
    CHECK((seen.low - field.box.low).cwiseAbs().maxCoeff() < 0.03);
    CHECK((seen.high - field.box.high).cwiseAbs().maxCoeff() < 0.03);
    for (const Point& x : field.places) CHECK(field.distance(x) < 1e-12);
    CHECK_FALSE(field.places.empty());
    for (int i = 0; i < 100; ++i) {
        const Point x = 2 * draw.vector();
        double nearest = 1e9;
        for (const Point& q : inside) nearest = std::min(nearest, (x - q).norm());
        CHECK(field.distance(x) <= nearest + 1e-12);
        CHECK(field.distance(x) > nearest - 0.06);
        // Nowhere does it change faster than the place.
        const Point y = x + 0.1 * draw.vector();
        CHECK(std::abs(field.distance(x) - field.distance(y)) <= (x - y).norm() * (1 + 1e-12));
    }
}

TEST_CASE("primitives request h inside, and grow by their own ratio or the common one") {
    const std::string ball = "ball:0,0,0,r=0.5,h=0.02", steep = "ball:0,0,0,r=0.5,h=0.02,g=2";
    CHECK(length_at({ball}, {0, 0.3, 0}) == 0.02);
    CHECK(length_at({ball}, {0, 0, 1.5}) == Approx(0.02 + 0.25).epsilon(1e-14));
    CHECK(length_at({ball}, {0, 0, 1.5}, 1.5) == Approx(0.02 + 0.5).epsilon(1e-14));
    CHECK(length_at({steep}, {0, 0, 1.5}) == Approx(0.02 + 1).epsilon(1e-14));
    CHECK(length_at({"ball:0,0,0,r=0.5,h=0.02,g=1"}, {9, 9, 9}) == 0.02);
    // The smallest of several.
    const std::string box = "box:1,2,-1,1,-1,1,h=0.1";
    Draw draw(2);
    for (int i = 0; i < 50; ++i) {
        const Point x = draw.vector();
        CHECK(length_at({steep, box}, x) == std::min(length_at({steep}, x), length_at({box}, x)));
    }
    CHECK_THROWS_AS(primitives_field({}, {}, 1.25), InputError);
}

TEST_CASE("primitives as texts are read again to the same bits") {
    for (const std::string text :
         {"box:-1,1,0,0.30000000000000004,0,3,h=0.02", "ball:0.1,0.2,0.3,r=0.1,h=0.02,g=1.5",
          "cylinder:0,0,0,0,0,1,r=0.1,h=1e-05", "segment:0,0,0,0,0,1,h=0.02",
          "surface:folder/part.stl,h=0.02,g=1.1"}) {
        CAPTURE(text);
        CHECK(is_primitive(text));
        CHECK(to_string(parse_primitive(text)) == text);
    }
    CHECK(parse_primitive("ball:0,0,0,h=1,g=2,r=3") == parse_primitive("ball:0,0,0,r=3,h=1,g=2"));
    CHECK_FALSE(is_primitive("ball.csv"));
    CHECK_FALSE(is_primitive("ball"));
    CHECK_FALSE(is_primitive("c:/ball.csv"));
}

TEST_CASE("what is no primitive is refused with the text and the remedy") {
    const auto [text, expected] = GENERATE(table<std::string, std::string>({
        {"ball:0,0,0,r=-0.1,h=0.02", "r is -0.1: give a positive length"},
        {"ball:0,0,0,r=0,h=0.02", "r is 0: give a positive length"},
        {"ball:0,0,0,r=nan,h=0.02", "r is nan: give a positive length"},
        {"ball:0,0,0,r=1,h=0", "h is 0: give a positive length"},
        {"ball:0,0,0,r=1,h=-1", "h is -1: give a positive length"},
        {"ball:0,0,0,r=1,h=inf", "h is inf: give a positive length"},
        {"ball:0,nan,0,r=1,h=1", "nan is no coordinate: give finite ones"},
        {"ball:0,0,r=1,h=1", "2 coordinates, but 3 are needed: write ball:x,y,z,r="},
        {"ball:0,0,0,0,r=1,h=1", "4 coordinates, but 3 are needed"},
        {"ball:0,0,0,h=1", "the radius r is missing"},
        {"ball:0,0,0,r=1", "the length h is missing: write ball:"},
        {"ball:0,0,0,r=1,h=1,h=2", "h is given twice"},
        {"ball:0,0,0,radius=1,h=1", "unknown setting 'radius': known are r, h and g"},
        {"box:0,1,0,1,0,1,r=1,h=1", "unknown setting 'r': known are h and g"},
        {"ball:0,0,0,r=1,h=1,g=0.5", "g is 0.5: give a gradation ratio from 1"},
        {"ball:0,0,0,r=1,h=1,g=5.1", "g is 5.1: give a gradation ratio from 1 to 5"},
        {"ball:0,0,0,r=1,h=1,g=nan", "g is nan: give a gradation ratio from 1"},
        {"ball:0,0,x,r=1,h=1", "'x' is no number"},
        {"ball:0,0,0,r=1,h=", "'' is no number"},
        {"ball:", "'' is no number"},
        {"box:0,1,2,1,0,1,h=1", "y0 is 2 and y1 is 1: give y0 < y1"},
        {"box:0,0,0,1,0,1,h=1", "x0 is 0 and x1 is 0: give x0 < x1"},
        {"segment:1,2,3,1,2,3,h=1", "both ends are at the same place"},
        {"surface:,h=1", "no file is named: write surface:part.stl"},
        {"surface:a.stl,b.stl,h=1", "'b.stl' is no number"},
        {"surface:a.stl,1,h=1", "a file and its settings are enough"},
        {"cube:0,0,0,h=1", "begin with box:, ball:"},
    }));
    CAPTURE(text);
    CHECK_THAT(error_of(text), Contains(text + ": " + expected));
}

}  // namespace controlspace::primitives_test
