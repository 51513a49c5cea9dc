// SPDX-License-Identifier: Apache-2.0
#include "cones/order_free_cones.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <future>
#include <random>

#include "cones/cone_field.h"
#include "cones/own_growths.h"
#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "counting_allocator.h"
#include "metric/draw.h"
#include "metric/largest_within.h"

namespace controlspace::order_free_cones_test {
namespace {

constexpr double g = 1.25;
const Metric wide = Metric::isotropic(2);

using Sources = std::vector<PointSource>;

struct Work {
    std::string name;
    Sources sources;
    double anisotropy;
    double scale = 1;
    Metric largest = wide;
    /// Of squared lengths: what rounding of six numbers may make of them.
    double rounding() const { return 1e-12 + 1e-13 * anisotropy; }
};

// Normals of a sphere, lengths `across` and `anisotropy` times as long along it.
Sources layered_sphere(Draw& draw, const Point& centre, double radius, int n, double across,
                       double anisotropy) {
    Sources sources;
    for (int i = 0; i < n; ++i) {
        const Vector normal = draw.vector().normalized();
        sources.push_back(
            {centre + radius * normal, layer_metric(normal, across, anisotropy * across)});
    }
    return sources;
}

Sources scattered(Draw& draw, int n, double anisotropy) {
    Sources sources;
    for (int i = 0; i < n; ++i) {
        const double size = 0.05 * std::pow(20, draw.uniform(0, 1));
        sources.push_back({draw.vector(), draw.metric(size, anisotropy)});
    }
    return sources;
}

Sources joined(Sources a, const Sources& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Work scaled(Work work, double k) {
    for (PointSource& source : work.sources) {
        source.position *= k;
        source.metric = k * source.metric;
    }
    work.largest = k * work.largest;
    work.scale = k;
    work.name += " times " + std::to_string(k);
    return work;
}

std::vector<Work> works() {
    Draw draw(61);
    std::vector<Work> all;
    all.push_back({"sphere", sample_sphere({.h = 0.06, .s_a = 4, .s_n = 0.25}), 4});
    all.push_back({"planes", sample_planes({.h = 0.08, .s_a = 4, .s_n = 0.25}), 4});
    all.push_back({"layers 100:1", layered_sphere(draw, {0, 0, 0}, 0.8, 900, 0.001, 100), 100});
    all.push_back({"spheres that nearly touch",
                   joined(layered_sphere(draw, {-0.5, 0, 0}, 0.495, 500, 0.001, 100),
                          layered_sphere(draw, {0.5, 0, 0}, 0.495, 500, 0.001, 100)),
                   100});
    for (const double anisotropy : {1.5, 30.0, 1e6}) {
        all.push_back({"scattered", scattered(draw, 300, anisotropy), anisotropy});
    }
    for (const std::size_t i : {0, 2, 4, 5}) {
        all.push_back({all[i].name + ", ratios of their own",
                       with_own_growths(all[i].sources, draw), all[i].anisotropy});
    }
    all.push_back(scaled(all[0], 1e-9));
    all.push_back(scaled(all[4], 1e9));
    Sources few = scattered(draw, 40, 10);
    for (int i = 0; i < 40; ++i) few.push_back({few[0].position, draw.metric(0.1, 10)});
    few.push_back({few[0].position, Metric::isotropic(0.05)});
    all.push_back({"coincident places", few, 10});
    all.push_back({"at one place", {}, 3});
    for (int i = 0; i < 17; ++i) {
        const double h = 0.01 * std::pow(1.25, i);
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(i, Vector::UnitZ()).toRotationMatrix();
        all.back().sources.push_back({{0.1, 0.2, 0.7}, metric_from_frame({h, 3 * h, h}, turn)});
    }
    all.push_back({"in a narrow cap", scattered(draw, 100, 10), 10, 1, draw.metric(0.3, 20)});
    all.push_back({"one", scattered(draw, 1, 10), 10});
    all.push_back({"nine on a line", {}, 10});
    for (int i = 0; i < 9; ++i) {
        all.back().sources.push_back({{0.1 * i, 0, 0}, draw.metric(0.1, 10)});
    }
    return all;
}

// All over, near to sources, and at some.
std::vector<Point> places(const Work& work, Draw& draw, int n) {
    std::vector<Point> points;
    for (int i = 0; i < n; ++i) {
        const auto source = static_cast<std::size_t>(i) * 7919 % work.sources.size();
        const auto& [position, metric, growth] = work.sources[source];
        if (i % 2 == 0) points.emplace_back(work.scale * draw.vector());
        if (i % 4 == 1) points.emplace_back(position + metric.matrix() * draw.vector());
        if (i % 4 == 3) points.push_back(position);
    }
    return points;
}

// The cones of all sources, and at their end the largest metric and `further`.
std::vector<Metric> all_cones(const Work& work, const Point& p, const Metric* further = nullptr) {
    std::vector<Metric> cones;
    for (const PointSource& s : work.sources) cones.push_back(cone_factor(s, g, p) * s.metric);
    cones.push_back(work.largest);
    if (further != nullptr) cones.push_back(*further);
    return cones;
}

// With multipliers that name metrics of `all_cones`.
OrderFreeIntersection renamed(OrderFreeIntersection answer, std::size_t sources) {
    for (std::size_t k = 0; k < answer.count; ++k) {
        std::uint32_t& index = answer.multiplier[k].index;
        if (index == OrderFreeCones::index_of_largest) index = static_cast<std::uint32_t>(sources);
        if (index == OrderFreeCones::index_of_further) {
            index = static_cast<std::uint32_t>(sources + 1);
        }
    }
    return answer;
}

std::vector<Metric> evaluated(const ConeField& field, const std::vector<Point>& points) {
    std::vector<Metric> out(points.size());
    field.evaluate(points, out);
    return out;
}

ConeField field_of(const Work& work, double tolerance) {
    return {work.sources, g, work.largest, tolerance, IntersectionRule::order_free};
}

}  // namespace

TEST_CASE("order-free cones: within all cones, with a certificate that log det is near the best",
          "[long]") {
    const double tolerance = GENERATE(1e-1, 1e-2, 1e-3, 1e-6);
    Draw draw(62);
    for (const Work& work : works()) {
        CAPTURE(work.name, work.anisotropy, tolerance);
        const OrderFreeCones cones(work.sources, g, work.largest, tolerance);
        OrderFreeCones::Search search;
        const double allowed = 6 * std::log1p(tolerance) + work.rounding();
        for (const Point& p : places(work, draw, 24)) {
            const Metric further = draw.metric(0.5 * work.scale, 5);
            for (const Metric* other : {static_cast<const Metric*>(nullptr), &further}) {
                const std::vector<Metric> all = all_cones(work, p, other);
                const auto answer = renamed(cones.intersect(p, other, search), work.sources.size());
                CHECK(excess(answer, all) <= 1 + work.rounding());
                CHECK(answer.gap <= allowed);
                CHECK(proven_gap(answer, all) <= answer.gap + work.rounding());
            }
        }
    }
}

TEST_CASE("order-free cones: as large as the intersection of all cones") {
    constexpr double tolerance = 1e-3;
    Draw draw(63);
    for (const Work& work : works()) {
        CAPTURE(work.name, work.anisotropy);
        const ConeField field = field_of(work, tolerance);
        const std::vector<Point> points = places(work, draw, 12);
        const std::vector<Metric> answers = evaluated(field, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto best = order_free_intersection(all_cones(work, points[i]));
            const auto determinant = long_matrix(answers[i]).determinant();
            const double log_det = 2 * static_cast<double>(std::log(determinant));
            const double lost = log_det_square(best) - log_det;
            CHECK(lost <= 6 * std::log1p(tolerance) + best.gap + work.rounding());
            CHECK(lost >= -best.gap - work.rounding());
        }
    }
}

TEST_CASE("order-free cones: the same bits whatever the order of sources and places, and threads") {
    Draw draw(64);
    std::mt19937 engine(1);
    for (const Work& work : works()) {
        CAPTURE(work.name, work.anisotropy);
        std::vector<Point> points = places(work, draw, 20);
        const ConeField field = field_of(work, 1e-2);
        const std::vector<Metric> answers = evaluated(field, points);

        Work other = work;
        std::shuffle(other.sources.begin(), other.sources.end(), engine);
        CHECK(evaluated(field_of(other, 1e-2), points) == answers);

        std::vector<std::size_t> order(points.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::shuffle(order.begin(), order.end(), engine);
        ConeField::Memory memory;
        const auto one_by_one = [&] {
            std::vector<Metric> again(points.size());
            for (const std::size_t i : order) {
                field.evaluate({&points[i], 1}, {&again[i], 1}, memory);
            }
            return again;
        };
        CHECK(one_by_one() == answers);
        CHECK(std::async(std::launch::async, one_by_one).get() == answers);
        for (std::size_t i = 0; i < points.size(); i += 7) {
            CHECK(evaluated(field, {points[i]}).front() == answers[i]);
        }
    }
}

TEST_CASE("order-free cones: of those close to a start alone, the volume is no less") {
    constexpr double tolerance = 1e-2;
    const double gap = OrderFreeCones::gap_of(tolerance);
    const auto log_det = [](const OrderFreeIntersection& answer) {
        return 2 * std::log(std::abs(answer.factor.determinant()));
    };
    Draw draw(66);
    for (const Work& work : works()) {
        CAPTURE(work.name);
        const OrderFreeCones cones(work.sources, g, work.largest, tolerance);
        int alike = 0;
        const std::vector<Point> all = places(work, draw, 30);
        for (const Point& p : all) {
            OrderFreeCones::Search search;
            OrderFreeCones::Start start;
            OrderFreeCones::Start found;
            const Eigen::Matrix3d h = cones.intersect(p, nullptr, search, nullptr, &start).factor;
            const Point nearby = p + 0.2 * h * draw.vector();
            const double close = log_det(cones.intersect_close(nearby, nullptr, start, found));
            const double exact = log_det(cones.intersect(nearby, nullptr, search));
            CHECK(close >= exact - gap);
            alike += close <= exact + gap ? 1 : 0;
        }
        CHECK(alike >= 0.9 * static_cast<double>(all.size()));
    }
}

TEST_CASE("order-free cones: of no cone, one, and two, exactly") {
    Draw draw(65);
    const Metric largest = draw.metric(2, 3);
    const auto at = [&](const Sources& sources, const Point& p, const Metric* further = nullptr) {
        OrderFreeCones::Search search;
        return OrderFreeCones(sources, g, largest, 1e-2).intersect(p, further, search).metric();
    };
    const PointSource small{{0.1, 0.2, 0.3}, draw.metric(0.05, 4)};
    const Metric other = draw.metric(2, 3);
    CHECK(at({}, Point::Zero()) == largest);
    CHECK(length_difference(at({}, Point::Zero(), &other), intersection(largest, other)) < 1e-13);
    CHECK(at({small}, small.position) == small.metric);
    CHECK(at({small}, Point::Constant(1e3)) == largest);
    for (int i = 0; i < 50; ++i) {
        const Point p = draw.vector();
        const Metric cone = cone_factor(small, g, p) * small.metric;
        CHECK(length_difference(at({small}, p), intersection(largest, cone)) < 1e-12);
    }
}

TEST_CASE("order-free cones: the symmetry of the sources") {
    // Layers on a sphere, the same in all octants: so is the field, as lengths allow it.
    constexpr double tolerance = 1e-6;
    Draw draw(66);
    Sources sources;
    for (const auto& [position, metric, growth] :
         layered_sphere(draw, Point::Zero(), 0.8, 100, 0.02, 10)) {
        for (int octant = 0; octant < 8; ++octant) {
            const Vector sign((octant & 1) != 0 ? -1 : 1, (octant & 2) != 0 ? -1 : 1,
                              (octant & 4) != 0 ? -1 : 1);
            const Eigen::Matrix3d mirror = sign.asDiagonal();
            sources.push_back({mirror * position, rotated(metric, mirror)});
        }
    }
    const ConeField field(sources, g, wide, tolerance, IntersectionRule::order_free);
    for (int i = 0; i < 20; ++i) {
        const Point p = 0.5 * draw.vector();
        const Eigen::Matrix3d mirror = Vector(-1, 1, -1).asDiagonal();
        const auto answers = evaluated(field, {p, mirror * p});
        CHECK(length_difference(rotated(answers[0], mirror), answers[1]) <
              4 * std::sqrt(3 * tolerance));
    }
}

TEST_CASE("order-free cones: without gradation the metrics themselves are intersected") {
    Draw draw(67);
    const Sources sources = scattered(draw, 200, 20);
    std::vector<Metric> metrics{wide};
    for (const PointSource& s : sources) metrics.push_back(s.metric);
    const OrderFreeCones cones(sources, 1, wide, 1e-4);
    OrderFreeCones::Search search;
    for (int i = 0; i < 10; ++i) {
        const auto answer = cones.intersect(10 * draw.vector(), nullptr, search);
        CHECK(excess(answer, metrics) <= 1 + 1e-11);
        CHECK(answer.gap <= 6e-4);
    }
}

TEST_CASE("order-free cones: places far away, and such as are none") {
    Draw draw(68);
    const Sources sources = scattered(draw, 50, 5);
    const OrderFreeCones cones(sources, g, wide, 1e-2);
    OrderFreeCones::Search search;
    const double infinite = std::numeric_limits<double>::infinity();
    for (const double far : {1e3, 1e9, 1e100}) {
        CHECK(cones.intersect(Point(far, -far, 0), nullptr, search).metric() == wide);
    }
    for (const double bad : {infinite, -infinite, std::nan("")}) {
        cones.intersect(Point(0, bad, 0), nullptr, search);
    }
    const Point p = draw.vector();
    OrderFreeCones::Search unused;
    CHECK(cones.intersect(p, nullptr, search).metric() ==
          cones.intersect(p, nullptr, unused).metric());
}

TEST_CASE("order-free cones: a search allocates once") {
    Draw draw(69);
    const Work work = works()[0];
    const OrderFreeCones cones(work.sources, g, work.largest, 1e-2);
    OrderFreeCones::Search search;
    const std::vector<Point> points = places(work, draw, 100);
    for (const Point& p : points) cones.intersect(p, nullptr, search);
    const std::size_t before = live_bytes();
    reset_peak_bytes();
    for (const Point& p : points) cones.intersect(p, nullptr, search);
    const std::size_t peak = peak_bytes();
    CHECK(peak == before);
}

TEST_CASE("order-free cones: metrics that are none are refused") {
    Draw draw(70);
    const Sources sources = scattered(draw, 30, 4);
    const OrderFreeCones cones(sources, g, wide, 1e-2);
    OrderFreeCones::Search search;
    const double nan = std::nan("");
    for (const Metric& bad :
         {Metric{-1, 1, 1, 0, 0, 0}, Metric{1, 1, 1, 2, 0, 0}, Metric{nan, 1, 1, 0, 0, 0}}) {
        CHECK_THROWS_WITH(cones.intersect(draw.vector(), &bad, search),
                          Catch::Contains("further metric"));
        CHECK_THROWS_WITH(OrderFreeCones({}, g, bad, 1e-2), Catch::Contains("largest metric"));
    }
}

TEST_CASE("order-free cones: sources of too large an anisotropy are refused") {
    Draw draw(70);
    Sources sources = scattered(draw, 3, 4);
    sources[1].metric = {1e9, 1, 1, 0, 0, 0};
    CHECK_THROWS_AS(OrderFreeCones(sources, g, wide, 1e-2), InputError);
    CHECK_THROWS_WITH(OrderFreeCones(sources, g, wide, 1e-2),
                      Catch::Contains("source 1") && Catch::Contains("anisotropy"));
}

}  // namespace controlspace::order_free_cones_test
