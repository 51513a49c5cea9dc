// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "cones/cone_field.h"
#include "cones/own_growths.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "metric/draw.h"

namespace controlspace::cones_of_boxes_test {
namespace {

constexpr double g = 1.25;
constexpr double cap = 2;
const Metric wide = Metric::isotropic(cap);

Point place(Draw& draw) { return draw.vector(); }

// A box with edges of different lengths.
Box box_of(Draw& draw, double size) {
    const Point centre = place(draw);
    const Vector half = 0.5 * size * Vector(1, draw.uniform(0.3, 1), draw.uniform(0.3, 1));
    return {centre - half, centre + half};
}

Point place_in_box(Draw& draw, const Box& box) {
    return box.low + Vector(draw.uniform(0, 1), draw.uniform(0, 1), draw.uniform(0, 1))
                         .cwiseProduct(box.edges());
}

// Many sizes; some sources at one place, some alike.
std::vector<PointSource> scattered(Draw& draw, double least) {
    std::vector<PointSource> sources;
    for (int i = 0; i < 2000; ++i) {
        const double h = least * std::pow(0.5 / least, draw.uniform(0, 1));
        sources.push_back({place(draw), Metric::isotropic(h)});
        if (i % 10 == 0) sources.push_back(sources.back());
    }
    return sources;
}

double length(const PointSource& s, double distance) {
    return s.metric.xx + (cone_growth(s, g) - 1) * distance;
}

double nearest(const Box& box, const Point& q) {
    return (q - q.cwiseMax(box.low).cwiseMin(box.high)).norm();
}
double farthest(const Box& box, const Point& q) {
    return ((q - box.centre()).cwiseAbs() + 0.5 * box.edges()).norm();
}

template <class Distance>
double smallest_of(const std::vector<PointSource>& sources, Distance&& distance) {
    double smallest = cap;
    for (const PointSource& s : sources) {
        smallest = std::min(smallest, length(s, distance(s.position)));
    }
    return smallest;
}

}  // namespace

TEST_CASE("cones gathered for a box make the exact field there") {
    Draw draw(1);
    for (const auto& sources :
         {scattered(draw, 0.02), scattered(draw, 1e-9), sample_sphere({.h = 0.1}),
          with_own_growths(scattered(draw, 0.02), draw),
          with_own_growths(sample_sphere({.h = 0.1}), draw)}) {
        const ConeField field(sources, g, wide);
        IsotropicCones::Hint hint = 0;
        ConeList cones;
        int few = 0;
        for (int k = 0; k < 300; ++k) {
            const Box box = box_of(draw, std::pow(10, draw.uniform(-3, 0)));
            if (!field.isotropic().gather(box, cones, hint)) continue;
            ++few;
            for (int i = 0; i < 20; ++i) {
                const Point x = place_in_box(draw, box);
                const double exact =
                    smallest_of(sources, [&](const Point& q) { return (x - q).norm(); });
                REQUIRE(cones.smallest_length(x, cap) == Approx(exact).epsilon(1e-12));
            }
        }
        CHECK(few > 100);
    }
}

TEST_CASE("what cannot be gathered is refused") {
    ConeList cones;
    IsotropicCones::Hint hint = 0;
    const Box box{Point::Constant(-1), Point::Constant(1)};
    CHECK_FALSE(ConeField(sample_sphere({}), g, wide).isotropic().gather(box, cones, hint));
    CHECK(ConeField(SourceColumns(), g, wide).isotropic().gather(box, cones, hint));
    CHECK(cones.smallest_length(Point::Zero(), cap) == cap);
}

TEST_CASE("bounds in a box: the least is met, and one cone stays below the most") {
    Draw draw(3);
    for (const auto& sources : {scattered(draw, 0.02), sample_sphere({.h = 0.1}),
                                with_own_growths(scattered(draw, 0.02), draw)}) {
        const ConeField field(sources, g, wide);
        IsotropicCones::Hint hint = 0;
        for (int k = 0; k < 200; ++k) {
            const Box box = box_of(draw, std::pow(10, draw.uniform(-3, 0.3)));
            const auto [least, most] = field.isotropic().range_in(box, hint);
            const auto near = [&](const Point& q) { return nearest(box, q); };
            const auto far = [&](const Point& q) { return farthest(box, q); };
            REQUIRE(least == Approx(smallest_of(sources, near)).epsilon(1e-12));
            REQUIRE(most == Approx(smallest_of(sources, far)).epsilon(1e-12));
        }
    }
    const auto [least, most] = [&] {
        IsotropicCones::Hint hint = 0;
        return ConeField(SourceColumns(), g, wide)
            .isotropic()
            .range_in({Point::Zero(), Point::Ones()}, hint);
    }();
    CHECK(least == cap);
    CHECK(most == cap);
}

TEST_CASE("a rough answer is never below the exact one, nor above it by more than requested") {
    Draw draw(4);
    const auto sources = sample_sphere({.h = 0.05});
    const ConeField field(sources, g, wide);
    for (const double tolerance : {0.0, 0.01, 0.2}) {
        IsotropicCones::Hint hint = 0;
        bool differs = false;
        for (int k = 0; k < 500; ++k) {
            const Point x = place(draw);
            Metric exact;
            field.evaluate({&x, 1}, {&exact, 1});
            const double rough = field.isotropic().smallest_length(x, hint, tolerance);
            CHECK(rough >= exact.xx);
            CHECK(rough <= exact.xx * (1 + tolerance) * (1 + 1e-12));
            differs = differs || rough != exact.xx;
        }
        CHECK(differs == (tolerance > 0));
    }
}

TEST_CASE("a source is found where it is below a length, and nowhere else") {
    Draw draw(5);
    const auto sources = with_own_growths(scattered(draw, 0.02), draw);
    const ConeField field(sources, g, wide);
    IsotropicCones::Hint hint = 0;
    for (int k = 0; k < 300; ++k) {
        const Point x = place(draw);
        const double exact = smallest_of(sources, [&](const Point& q) { return (x - q).norm(); });
        CHECK_FALSE(field.isotropic().source_below(x, exact * (1 - 1e-12), hint).has_value());
        const auto found = field.isotropic().source_below(x, exact * (1 + 1e-12), hint);
        REQUIRE(found.has_value());
        const double own = length(sources[*found], (x - sources[*found].position).norm());
        CHECK(own == Approx(exact).epsilon(1e-12));
    }
}

}  // namespace controlspace::cones_of_boxes_test
