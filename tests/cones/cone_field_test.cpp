// SPDX-License-Identifier: Apache-2.0
#include "cones/cone_field.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "cones/own_growths.h"
#include "cones/spatial_order.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "metric/draw.h"

namespace controlspace::cone_field_test {
namespace {

constexpr double g = 1.25;
const Metric wide = Metric::isotropic(2);
constexpr auto in_turn = IntersectionRule::in_turn;

std::vector<Point> places(Draw& draw, int n) {
    std::vector<Point> points;
    for (int i = 0; i < n; ++i) points.emplace_back(draw.vector());
    return points;
}

// Lengths over two decades: many sources lie within the reach of smaller ones.
std::vector<PointSource> scattered(Draw& draw, int n, double anisotropy) {
    std::vector<PointSource> sources;
    for (const Point& q : places(draw, n)) {
        const double size = 0.02 * std::pow(100, draw.uniform(0, 1));
        sources.push_back(
            {q, anisotropy > 1 ? draw.metric(size, anisotropy) : Metric::isotropic(size)});
    }
    return sources;
}

std::vector<Metric> evaluated(const ConeField& field, const std::vector<Point>& points) {
    std::vector<Metric> out(points.size());
    field.evaluate(points, out);
    return out;
}

std::vector<Metric> by_definition(const std::vector<PointSource>& sources,
                                  const std::vector<Point>& points) {
    std::vector<Metric> out(points.size());
    brute_force_reference(sources, g, wide)->sample(points, out);
    return out;
}

// To the definition.
double largest_difference(const ConeField& field, const std::vector<PointSource>& sources,
                          const std::vector<Point>& points) {
    const auto now = evaluated(field, points);
    const auto wanted = by_definition(sources, points);
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        worst = std::max(worst, difference(now[i], wanted[i]));
    }
    return worst;
}

}  // namespace

TEST_CASE("Isotropic sources that another's cone reaches are dropped, and no others") {
    Draw draw(1);
    const auto sources = scattered(draw, 1000, 1);
    const auto reached = [&](const PointSource& i) {
        return std::any_of(sources.begin(), sources.end(), [&](const PointSource& j) {
            return cone_factor(j, g, i.position) * j.metric.xx < i.metric.xx;
        });
    };
    const auto count = std::count_if(sources.begin(), sources.end(), reached);
    const ConeField field(sources, g, wide, 0, in_turn);
    CHECK(count > 100);
    CHECK(count < 900);
    CHECK(field.dropped() == static_cast<std::size_t>(count));
    const auto points = places(draw, 300);
    CHECK(evaluated(field, points) == by_definition(sources, points));
}

TEST_CASE("Isotropic sources with ratios of their own: the smallest cone, to the bit") {
    Draw draw(11);
    const auto sources = with_own_growths(scattered(draw, 1000, 1), draw);
    const ConeField field(sources, g, wide);
    CHECK(field.dropped() > 100);
    const auto points = places(draw, 2000);
    CHECK(evaluated(field, points) == by_definition(sources, points));
}

TEST_CASE("Lengths of a batch are those of single searches, to the bit, in any company") {
    Draw draw(11);
    std::vector<PointSource> sources = scattered(draw, 3000, 1);
    const bool is_flat = GENERATE(false, true);
    const auto slopes = GENERATE(table<double, double>({{1.25, 1.25}, {1, 3}, {1, 1}, {1, 1e6}}));
    for (PointSource& s : sources) {
        if (is_flat) s.position.z() = 0;
        s.growth = draw.uniform(std::get<0>(slopes), std::get<1>(slopes));
    }
    // Some lie on a line at equal distances, where two are as near; and some twice.
    for (int i = 0; i < 400; ++i) {
        sources.push_back({Point(i / 400., 0.5, 0), Metric::isotropic(0.02), 1.25});
    }
    sources.insert(sources.end(), sources.begin(), sources.begin() + 100);
    const ConeField field(sources, g, wide);

    std::vector<Point> x;
    for (int j = 0; j < 40; ++j) {
        for (int i = 0; i < 50; ++i) x.emplace_back(i / 50., j / 400. + 0.45, 0);
    }
    for (const Point& p : places(draw, 500)) x.push_back(2 * p);
    std::vector<double> lengths(x.size());
    field.evaluate_lengths(x, lengths);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        ConeField::Memory memory;
        Metric alone;
        field.evaluate({&x[i], 1}, {&alone, 1}, memory);
        double smallest = wide.xx;
        for (const PointSource& s : sources) {
            smallest = std::min(smallest, cone_factor(s, g, x[i]) * s.metric.xx);
        }
        if (lengths[i] != alone.xx || lengths[i] != smallest) ++wrong;
    }
    CHECK(wrong == 0);
    // Neighbours in the batch change nothing.
    std::vector<double> part(37);
    field.evaluate_lengths(std::span(x).subspan(1000, part.size()), part);
    CHECK(std::equal(part.begin(), part.end(), lengths.begin() + 1000));
}

TEST_CASE("Lengths of a batch, of few sources and many, far from the origin, beside no numbers") {
    Draw draw(12);
    const int count = GENERATE(1, 16, 17, 128, 129, 1500);
    // So far that coordinates are multiples of 0.002.
    const double offset = GENERATE(0.0, 1e13);
    std::vector<PointSource> sources;
    for (const Point& q : places(draw, count)) {
        sources.push_back({q + Point::Constant(offset), Metric::isotropic(0.05)});
    }
    const ConeField field(sources, g, wide);
    std::vector<Point> x;
    for (const Point& p : places(draw, 500)) x.push_back(p + Point::Constant(offset));
    const auto expected = by_definition(sources, x);
    CHECK(evaluated(field, x) == expected);

    const double none = std::numeric_limits<double>::quiet_NaN();
    x.front() = Point(none, none, none);
    x.back() = Point(1e300, 0, 0);
    const auto found = evaluated(field, x);
    CHECK(std::equal(found.begin() + 1, found.end() - 1, expected.begin() + 1));
}

TEST_CASE("A source in a steeper cone is dropped only where that stays below it up to the cap") {
    const PointSource steep{Point::Zero(), Metric::isotropic(0.1), 2};
    const auto dropped = [&](const PointSource& other) {
        const std::vector<PointSource> sources{steep, other};
        const ConeField field(sources, g, wide);
        Draw draw(12);
        const auto points = places(draw, 200);
        CHECK(evaluated(field, points) == by_definition(sources, points));
        return field.dropped() == 1;
    };
    const Point near(0.1, 0, 0);  // where the steep cone is 0.2
    CHECK_FALSE(dropped({near, Metric::isotropic(0.3)}));
    CHECK_FALSE(dropped({near, Metric::isotropic(0.3), 1}));
    CHECK(dropped({near, Metric::isotropic(0.3), 2}));
    CHECK(dropped({near, Metric::isotropic(0.3), 3}));
    CHECK(dropped({near, Metric::isotropic(1.95), 1.9}));
    CHECK_FALSE(dropped({near, Metric::isotropic(0.19), 2}));
    CHECK_FALSE(dropped({steep.position, Metric::isotropic(0.3), 1.5}));
    CHECK(dropped({steep.position, Metric::isotropic(0.3), 2}));
}

TEST_CASE("Tensors with ratios of their own: the cones in turn") {
    Draw draw(13);
    const auto sources = with_own_growths(scattered(draw, 300, 1.3), draw);
    const ConeField field(sources, g, wide, 0, in_turn);
    CHECK(field.dropped() > 20);
    const auto points = places(draw, 300);
    CHECK(largest_difference(field, sources, points) < 1e-12);
}

TEST_CASE("Sources that are there twice are dropped once") {
    const double s_n = GENERATE(1.0, 0.25);
    auto sources = sample_sphere({.h = 0.1, .s_n = s_n, .rho = 1});
    std::vector<PointSource> different;
    for (const PointSource& s : sources) {
        if (std::find(different.begin(), different.end(), s) == different.end())
            different.push_back(s);
    }
    const std::size_t twice = sources.size() - different.size();
    CHECK(twice > 0);
    CHECK(ConeField(sources, g, wide, 0, in_turn).dropped() == twice);
}

TEST_CASE("Anisotropic sources that cannot matter are dropped, and the field stays") {
    const Metric m = metric_from_frame({0.1, 0.2, 0.4}, Draw(2).rotation());
    const PointSource governs{Point::Zero(), m};
    const Point away(0.3, 0, 0);
    const double k = cone_factor(governs, g, away);
    const auto dropped = [&](const PointSource& other) {
        const std::vector<PointSource> sources{governs, other};
        const ConeField field(sources, g, wide, 0, in_turn);
        Draw draw(3);
        const auto points = places(draw, 100);
        CHECK(largest_difference(field, sources, points) < 1e-12);
        return field.dropped() == 1;
    };
    CHECK(dropped(governs));
    // Of the same shape, just outside of the cone and just within.
    CHECK(dropped({away, 1.001 * k * m}));
    CHECK_FALSE(dropped({away, 0.999 * k * m}));
    // Of another shape, outside of the cone here. Further out the cone outgrows it, so it can be
    // left out only if it has met the largest metric by then.
    const Metric longer{0.5, 0.45, 0.5, 0, 0, 0};
    CHECK(is_within(m, k, longer));
    CHECK_FALSE(dropped({away, longer}));
    CHECK(dropped({away, 4.0 * longer}));
    // Crossing.
    CHECK_FALSE(dropped({Point::Zero(), metric_from_frame({0.1, 0.2, 0.4}, Draw(4).rotation())}));
}

TEST_CASE("Dropping anisotropic sources of many sizes leaves the field as it is") {
    const double anisotropy = GENERATE(1.01, 1.3, 4.0);
    Draw draw(5);
    auto sources = scattered(draw, 400, anisotropy);
    const auto points = places(draw, 200);
    const ConeField field(sources, g, wide, 0, in_turn);
    CHECK(largest_difference(field, sources, points) < 1e-12);
    if (anisotropy < 1.1) CHECK(field.dropped() > 40);
}

TEST_CASE("With a tolerance no cone is exceeded by more") {
    Draw draw(6);
    const auto sources = sample_sphere({.h = 0.1, .s_a = 4, .s_n = 0.25});
    const auto points = places(draw, 100);
    const auto exact = evaluated(ConeField(sources, g, wide, 0, in_turn), points);
    for (const double tolerance : {1e-6, 1e-3, 1e-1}) {
        const auto near = evaluated(ConeField(sources, g, wide, tolerance, in_turn), points);
        double worst = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (const PointSource& s : sources) {
                const double factor = cone_factor(s, g, points[i]);
                worst = std::max(worst, growth(near[i], factor * s.metric) - 1);
            }
        }
        CHECK(worst < tolerance * (1 + 1e-6));
        CHECK(near != exact);
    }
}

TEST_CASE("The governing sources make the field, and each of them counts") {
    const double anisotropy = GENERATE(1.0, 4.0);
    Draw draw(8);
    // Many at one place, and many dropped: indices are those of the sources as given.
    auto sources = scattered(draw, 500, anisotropy);
    sources.insert(sources.begin() + 100, sources.begin(), sources.begin() + 50);
    auto points = places(draw, 200);
    points.push_back(Point::Constant(100));  // out of reach
    const Metric largest = draw.metric(0.6, 1.5);
    const ConeField field(sources, g, largest, 0, in_turn);
    const auto exact = evaluated(field, points);
    std::vector<std::uint32_t> governing{1, 2, 3};
    std::size_t most = 0;
    std::size_t without = 0;
    ConeField::Memory memory;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Metric m;
        field.governing(points[i], 0, governing, m, memory);
        CHECK(m == exact[i]);
        Metric again = largest;
        double shortest = 0;
        for (const std::uint32_t s : governing) {
            REQUIRE(s < sources.size());
            const Metric cone = cone_factor(sources[s], g, points[i]) * sources[s].metric;
            CHECK(eigen_frame(cone).lengths[0] >= shortest * (1 - 1e-12));
            shortest = eigen_frame(cone).lengths[0];
            const Metric before = again;
            again = intersection(again, cone);
            CHECK(again != before);
        }
        CHECK(difference(again, m) < 1e-13);
        most = std::max(most, governing.size());
        without += governing.empty() ? 1 : 0;
    }
    CHECK((anisotropy > 1 ? most > 3 : most == 1));
    CHECK(without == 1);
}

TEST_CASE("Sources that cut by less than the tolerance do not govern") {
    const double s_n = GENERATE(1.0, 0.25);
    Draw draw(9);
    const auto sources = sample_sphere({.h = 0.1, .s_a = 4, .s_n = s_n});
    const ConeField field(sources, g, wide, 0, in_turn);
    std::size_t last = sources.size() * sources.size();
    const auto points = places(draw, 50);
    for (const double tolerance : {1e-9, 1e-3, 0.1, 100.0}) {
        std::size_t count = 0;
        for (const Point& p : points) {
            std::vector<std::uint32_t> governing;
            Metric m;
            ConeField::Memory memory;
            field.governing(p, tolerance, governing, m, memory);
            count += governing.size();
            Metric again = wide;
            for (const std::uint32_t s : governing) {
                const Metric cone = cone_factor(sources[s], g, p) * sources[s].metric;
                CHECK(growth(again, cone) > (1 + tolerance) * (1 - 1e-6));
                again = intersection(again, cone);
            }
            CHECK(difference(again, m) < 1e-13);
            for (const PointSource& s : sources) {
                const double factor = cone_factor(s, g, p);
                CHECK(growth(m, factor * s.metric) < (1 + tolerance) * (1 + 1e-9));
            }
        }
        CHECK((s_n < 1 ? count < last : count <= last));
        last = count;
    }
    CHECK(last == 0);
}

TEST_CASE("A spatial order names every point once, and neighbours together") {
    Draw draw(7);
    std::vector<Point> points = places(draw, 5000);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto way = [&](const std::vector<std::uint32_t>& order) {
        double sum = 0;
        for (std::size_t i = 1; i < order.size(); ++i) {
            sum += (points[order[i]] - points[order[i - 1]]).norm();
        }
        return sum;
    };
    auto order = spatial_order(points);
    auto sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t i = 0; i < sorted.size(); ++i) REQUIRE(sorted[i] == i);
    CHECK(way(order) < 0.2 * way(sorted));

    CHECK(spatial_order({}).empty());
    CHECK(spatial_order(std::vector<Point>(3, Point::Zero())).size() == 3);
    points[10] = Point::Constant(nan);
    points[11] = Point::Constant(std::numeric_limits<double>::infinity());
    CHECK(spatial_order(points).size() == points.size());
}

}  // namespace controlspace::cone_field_test
