#include "cones/nearby_cones.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "cones/cone_field.h"
#include "cones/own_growths.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "metric/draw.h"

using namespace controlspace;

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

TEST_CASE("cones gathered for a box, and narrowed to parts of it, make the exact field there") {
    Draw draw(1);
    for (const auto& sources :
         {scattered(draw, 0.02), scattered(draw, 1e-9), sample_sphere({.h = 0.1}),
          with_own_growths(scattered(draw, 0.02), draw),
          with_own_growths(sample_sphere({.h = 0.1}), draw)}) {
        const ConeField field(sources, g, wide);
        ConeField::Memory memory;
        NearbyCones gathered, cones, parts;
        int few = 0;
        for (int k = 0; k < 300; ++k) {
            const Box box = box_of(draw, std::pow(10, draw.uniform(-3, 0)));
            if (!field.gather(box, gathered, memory)) continue;
            ++few;
            cones.narrow(gathered, box);
            REQUIRE(cones.size() <= gathered.size());
            const Box part{box.low, box.centre()};
            parts.narrow(cones, part);
            for (int i = 0; i < 20; ++i) {
                const bool in_part = i % 2 == 0;
                const NearbyCones& near = in_part ? parts : cones;
                const Point x = place_in_box(draw, in_part ? part : box);
                const double exact =
                    smallest_of(sources, [&](const Point& q) { return (x - q).norm(); });
                REQUIRE(near.smallest_length(x) == Approx(exact).epsilon(1e-12));
            }
        }
        CHECK(few > 100);
    }
}

TEST_CASE("what cannot be gathered is refused") {
    Draw draw(2);
    NearbyCones cones;
    ConeField::Memory memory;
    CHECK_FALSE(ConeField(sample_sphere({}), g, wide)
                    .gather({Point::Constant(-1), Point::Constant(1)}, cones, memory));
    const std::vector<PointSource> tensor{{Point::Zero(), draw.metric(0.1, 3)}};
    CHECK_FALSE(ConeField(tensor, g, wide)
                    .gather({Point::Constant(-1), Point::Constant(1)}, cones, memory));
    CHECK(ConeField({}, g, wide).gather({Point::Zero(), Point::Ones()}, cones, memory));
    CHECK(cones.smallest_length(Point::Zero()) == cap);
}

TEST_CASE("bounds in a box: the least is met, and one cone stays below the most") {
    Draw draw(3);
    for (const auto& sources : {scattered(draw, 0.02), sample_sphere({.h = 0.1}),
                                with_own_growths(scattered(draw, 0.02), draw)}) {
        const ConeField field(sources, g, wide);
        ConeField::Memory memory;
        for (int k = 0; k < 200; ++k) {
            const Box box = box_of(draw, std::pow(10, draw.uniform(-3, 0.3)));
            const auto [least, most] = field.range_in(box, memory);
            const auto near = [&](const Point& q) { return nearest(box, q); };
            const auto far = [&](const Point& q) { return farthest(box, q); };
            REQUIRE(least == Approx(smallest_of(sources, near)).epsilon(1e-12));
            REQUIRE(most == Approx(smallest_of(sources, far)).epsilon(1e-12));
        }
    }
    const auto [least, most] = [&] {
        ConeField::Memory memory;
        return ConeField({}, g, wide).range_in({Point::Zero(), Point::Ones()}, memory);
    }();
    CHECK(least == cap);
    CHECK(most == cap);
}

TEST_CASE("a rough answer is never below the exact one, nor above it by more than requested") {
    Draw draw(4);
    const auto sources = sample_sphere({.h = 0.05});
    const ConeField field(sources, g, wide);
    for (const double tolerance : {0.0, 0.01, 0.2}) {
        ConeField::Memory memory;
        bool differs = false;
        for (int k = 0; k < 500; ++k) {
            const Point x = place(draw);
            Metric exact, rough;
            field.evaluate({&x, 1}, {&exact, 1});
            field.evaluate_roughly({&x, 1}, tolerance, {&rough, 1}, memory);
            CHECK(rough.xx >= exact.xx);
            CHECK(rough.xx <= exact.xx * (1 + tolerance) * (1 + 1e-12));
            differs = differs || rough != exact;
        }
        CHECK(differs == (tolerance > 0));
    }
}

TEST_CASE("a source is found where it is below a length, and nowhere else") {
    Draw draw(5);
    const auto sources = with_own_growths(scattered(draw, 0.02), draw);
    const ConeField field(sources, g, wide);
    ConeField::Memory memory;
    for (int k = 0; k < 300; ++k) {
        const Point x = place(draw);
        const double exact = smallest_of(sources, [&](const Point& q) { return (x - q).norm(); });
        CHECK_FALSE(field.source_below(x, exact * (1 - 1e-12), memory).has_value());
        const auto found = field.source_below(x, exact * (1 + 1e-12), memory);
        REQUIRE(found.has_value());
        const double own = length(sources[*found], (x - sources[*found].position).norm());
        CHECK(own == Approx(exact).epsilon(1e-12));
    }
}
