// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/reference.h"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <limits>
#include <string>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "metric/draw.h"

namespace controlspace::reference_test {
namespace {

const Metric wide = Metric::isotropic(2);
constexpr auto in_turn = IntersectionRule::in_turn;

std::vector<Metric> evaluated(const ControlSpace& field, const std::vector<Point>& points) {
    std::vector<Metric> out(points.size());
    field.sample(points, out);
    return out;
}

Metric at(const ControlSpace& field, const Point& p) { return evaluated(field, {p})[0]; }

Point in_cube(Draw& draw) {
    const double x = draw.uniform(-1, 1);
    const double y = draw.uniform(-1, 1);
    return {x, y, draw.uniform(-1, 1)};
}

std::vector<Point> probes(Draw& draw, int n) {
    std::vector<Point> points;
    for (int i = 0; i < n; ++i) points.push_back(in_cube(draw));
    return points;
}

// Probes in the cube, far outside it, and at the sources themselves.
std::vector<Point> probes(Draw& draw, const std::vector<PointSource>& sources) {
    std::vector<Point> points = probes(draw, 40);
    for (int i = 0; i < 10; ++i) points.push_back(50 * in_cube(draw));
    for (std::size_t i = 0; i < sources.size() && i < 10; ++i) {
        points.push_back(sources[i].position);
    }
    return points;
}

// Whether the search in turn answers what the oracle does, to the bit or to a relative `tolerance`.
void require_oracle(const std::vector<PointSource>& sources, double g, const Metric& largest,
                    const std::vector<Point>& points, double tolerance) {
    const auto fast = evaluated(*exact_reference(sources, g, largest, 0, in_turn), points);
    const auto slow = evaluated(*brute_force_reference(sources, g, largest), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        INFO("point " << points[i].transpose() << ": " << to_string(fast[i]) << " instead of "
                      << to_string(slow[i]));
        if (tolerance == 0) {
            REQUIRE(fast[i] == slow[i]);
        } else {
            REQUIRE(difference(fast[i], slow[i]) <= tolerance);
        }
    }
}

// Where sources lie: what searches find hard.
enum class Layout { cube, clusters, plane, line, sphere, coincident };

std::vector<PointSource> scattered(Draw& draw, Layout layout, int n, double anisotropy,
                                   double size_range) {
    std::vector<PointSource> sources;
    const Vector centre(0.1, -0.2, 0.3);
    for (int i = 0; i < n; ++i) {
        Point q = in_cube(draw);
        if (layout == Layout::clusters) q = 0.5 * centre * (i % 3) + 1e-3 * q;
        if (layout == Layout::plane) q.z() = 0.25;
        if (layout == Layout::line) q = q.x() * Vector(1, 2, -1).normalized();
        if (layout == Layout::sphere) q = 0.8 * q.normalized();
        if (layout == Layout::coincident) q = centre;
        const double size = 0.05 * std::pow(size_range, draw.uniform(0, 1));
        sources.push_back(
            {q, anisotropy > 1 ? draw.metric(size, anisotropy) : Metric::isotropic(size)});
        if (i % 7 == 0) sources.push_back(sources[static_cast<std::size_t>(i) / 2]);  // a duplicate
    }
    return sources;
}

const auto all_layouts = {Layout::cube, Layout::clusters, Layout::plane,
                          Layout::line, Layout::sphere,   Layout::coincident};

// A surface layer: thin across the sphere, long along it.
std::vector<PointSource> layered_sphere(Draw& draw, int n, double across, double along) {
    std::vector<PointSource> sources;
    for (int i = 0; i < n; ++i) {
        const Vector normal = draw.vector().normalized();
        const Metric metric = Metric::from_matrix(along * Eigen::Matrix3d::Identity() +
                                                  (across - along) * normal * normal.transpose());
        sources.push_back({0.8 * normal, metric});
    }
    return sources;
}

}  // namespace

TEST_CASE("Without sources the field is the largest metric") {
    const Metric largest = metric_from_frame({1, 2, 3}, Draw(1).rotation());
    CHECK(at(*exact_reference(std::vector<PointSource>{}, 1.25, largest), Point(1, 2, 3)) ==
          largest);
    CHECK(at(*brute_force_reference({}, 1.25, largest), Point(1, 2, 3)) == largest);
}

TEST_CASE("One isotropic source makes a cone") {
    const auto field = exact_reference({{Point(1, 0, 0), Metric::isotropic(0.1)}}, 1.25, wide);
    CHECK(at(*field, Point(1, 0, 0)) == Metric::isotropic(0.1));
    const Metric m = at(*field, Point(1, 3, 4));
    CHECK(is_isotropic(m));
    CHECK(m.xx == Approx(0.1 + 0.25 * 5));
    CHECK(at(*field, Point(100, 0, 0)) == wide);
}

TEST_CASE("One anisotropic source keeps its shape as it grows") {
    const PointSource source{Point(0, 0, 0), {0.1, 0.4, 0.2, 0, 0, 0}};
    const auto field = exact_reference({source}, 1.5, Metric::isotropic(100));
    // 0.4 along y is one metric length, 0.2 along x are two.
    CHECK(difference(at(*field, Point(0, 0.4, 0)), 1.5 * source.metric) < 1e-15);
    CHECK(difference(at(*field, Point(0.2, 0, 0)), 2.0 * source.metric) < 1e-15);
}

TEST_CASE("Of two isotropic sources the smaller cone counts") {
    const auto field = exact_reference(
        {{Point(-1, 0, 0), Metric::isotropic(0.1)}, {Point(1, 0, 0), Metric::isotropic(0.3)}}, 1.2,
        wide);
    // 0.1 + 0.2 (1 + x) = 0.3 + 0.2 (1 - x) at x = 0.5.
    CHECK(at(*field, Point(0.4, 0, 0)).xx == Approx(0.1 + 0.2 * 1.4));
    CHECK(at(*field, Point(0.5, 0, 0)).xx == Approx(0.4));
    CHECK(at(*field, Point(0.7, 0, 0)).xx == Approx(0.3 + 0.2 * 0.3));
}

TEST_CASE("Crossing anisotropic sources at one place are intersected") {
    const Metric a{0.1, 1, 1, 0, 0, 0};
    const Metric b{1, 0.2, 1, 0, 0, 0};
    const auto field =
        exact_reference({{Point::Zero(), b}, {Point::Zero(), a}}, 1.25, wide, 0, in_turn);
    CHECK(at(*field, Point::Zero()) == Metric{0.1, 0.2, 1, 0, 0, 0});
    const auto order_free = exact_reference({{Point::Zero(), b}, {Point::Zero(), a}}, 1.25, wide);
    CHECK(nonconformity(at(*order_free, Point::Zero()), {0.1, 0.2, 1, 0, 0, 0}) < 1e-6);
}

TEST_CASE("Isotropic sources: the oracle's answer to the bit") {
    const double g = GENERATE(1.0, 1.0001, 1.25, 3.0);
    const double size_range = GENERATE(1.0, 10.0, 1e12);
    for (const Layout layout : all_layouts) {
        Draw draw(7);
        const auto sources = scattered(draw, layout, 400, 1, size_range);
        const Metric largest = Metric::isotropic(0.5 * size_range);
        require_oracle(sources, g, largest, probes(draw, sources), 0);
    }
}

TEST_CASE("Isotropic sources below an anisotropic largest metric: the oracle's answer") {
    Draw draw(8);
    const auto sources = scattered(draw, Layout::cube, 100, 1, 10);
    // The oracle cuts twice where a source is there twice: not to the bit.
    require_oracle(sources, 1.25, draw.metric(0.3, 5), probes(draw, sources), 1e-14);
}

TEST_CASE("Small sets of sources: the oracle's answer") {
    for (int n = 1; n <= 40; ++n) {
        Draw draw(static_cast<unsigned>(n));
        const auto isotropic = scattered(draw, Layout::cube, n, 1, 10);
        require_oracle(isotropic, 1.25, wide, probes(draw, isotropic), 0);
        const auto anisotropic = scattered(draw, Layout::cube, n, 10, 10);
        require_oracle(anisotropic, 1.25, wide, probes(draw, anisotropic), 1e-14);
    }
}

TEST_CASE("Anisotropic sources: the oracle's answer", "[long]") {
    const double g = GENERATE(1.0, 1.05, 1.25, 2.0);
    const double anisotropy = GENERATE(1.5, 10.0, 1000.0);
    const double size_range = GENERATE(1.0, 1e6);
    for (const Layout layout : all_layouts) {
        Draw draw(11);
        const auto sources = scattered(draw, layout, 250, anisotropy, size_range);
        const Metric largest = Metric::isotropic(0.5 * size_range);
        require_oracle(sources, g, largest, probes(draw, sources), 1e-12);
    }
}

TEST_CASE("Layers on a sphere, where many sources count at once: the oracle's answer") {
    const double along = GENERATE(0.06, 1.5);
    Draw draw(12);
    const auto sources = layered_sphere(draw, 3000, 0.015, along);
    require_oracle(sources, 1.25, Metric::isotropic(std::sqrt(3)), probes(draw, sources), 1e-12);
}

TEST_CASE("Isotropic and anisotropic sources together: the oracle's answer") {
    Draw draw(13);
    auto sources = scattered(draw, Layout::cube, 300, 1, 10);
    const auto more = scattered(draw, Layout::cube, 300, 20, 10);
    sources.insert(sources.end(), more.begin(), more.end());
    require_oracle(sources, 1.25, wide, probes(draw, sources), 1e-12);
}

TEST_CASE("An anisotropic source too far to matter leaves isotropic answers as they are") {
    Draw draw(14);
    auto sources = scattered(draw, Layout::sphere, 2000, 1, 3);
    const auto points = probes(draw, sources);
    const auto alone = evaluated(*exact_reference(sources, 1.25, wide), points);
    sources.push_back({Point(1e6, 0, 0), {1, 2, 3, 0, 0, 0}});
    CHECK(evaluated(*exact_reference(sources, 1.25, wide, 0, in_turn), points) == alone);
    const auto order_free = evaluated(*exact_reference(sources, 1.25, wide), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(nonconformity(order_free[i], alone[i]) < 1e-6);
    }
}

TEST_CASE("The field is never longer than any cone") {
    const auto rule = GENERATE(IntersectionRule::order_free, in_turn);
    Draw draw(15);
    const auto sources = scattered(draw, Layout::cube, 300, 30, 10);
    const auto points = probes(draw, sources);
    const auto field = evaluated(*exact_reference(sources, 1.25, wide, 0, rule), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(is_positive_definite(field[i]));
        CHECK(is_within(field[i], 1, wide));
        for (const PointSource& s : sources) {
            const double factor = 1 + 0.25 * metric_length(s.metric, points[i] - s.position);
            REQUIRE(growth(field[i], s.metric) <= factor * (1 + 1e-11));
        }
    }
}

TEST_CASE("The field turns with its sources") {
    // Order-free, log det is exact to 3e-7, lengths to the square root of that.
    const auto [rule, rounding] = GENERATE(table<IntersectionRule, double>(
        {{IntersectionRule::order_free, 1e-3}, {IntersectionRule::in_turn, 1e-9}}));
    Draw draw(16);
    auto sources = scattered(draw, Layout::cube, 200, 8, 10);
    auto points = probes(draw, sources);
    const auto before = evaluated(*exact_reference(sources, 1.25, wide, 0, rule), points);
    const Eigen::Matrix3d turn = draw.rotation();
    for (PointSource& s : sources) s = {turn * s.position, rotated(s.metric, turn)};
    for (Point& p : points) p = turn * p;
    const auto after = evaluated(*exact_reference(sources, 1.25, wide, 0, rule), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(difference(after[i], rotated(before[i], turn)) < rounding);
    }
}

TEST_CASE("The isotropic field grows with the gradation ratio") {
    Draw draw(17);
    const auto sources = scattered(draw, Layout::cube, 200, 1, 10);
    const auto points = probes(draw, 200);
    std::vector<Metric> before(points.size(), Metric::isotropic(0));
    for (const double g : {1.0, 1.1, 1.25, 2.0}) {
        const auto now = evaluated(*exact_reference(sources, g, wide), points);
        bool grew = false;
        for (std::size_t i = 0; i < points.size(); ++i) {
            REQUIRE(now[i].xx >= before[i].xx);
            grew = grew || now[i].xx > before[i].xx;
        }
        CHECK(grew);
        before = now;
    }
}

TEST_CASE("Answers do not depend on the number of threads or on the batch") {
    const auto rule = GENERATE(IntersectionRule::order_free, in_turn);
    Draw draw(18);
    const auto sources = scattered(draw, Layout::cube, 2000, 5, 10);
    const auto points = probes(draw, 150);
    const auto many = evaluated(*exact_reference(sources, 1.25, wide, 0, rule), points);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto field = exact_reference(sources, 1.25, wide, 0, rule);
    CHECK(evaluated(*field, points) == many);
    for (std::size_t i = 0; i < 20; ++i) CHECK(at(*field, points[i]) == many[i]);
}

TEST_CASE("What no reference can be made of is named") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const PointSource good{Point::Zero(), wide};
    const auto exact = [](std::vector<PointSource> sources, double g, const Metric& largest) {
        return exact_reference(std::move(sources), g, largest);
    };
    CHECK_THROWS_WITH(exact_reference({good}, 1.25, wide, -1), Catch::Contains("tolerance -1"));
    CHECK_THROWS_AS(exact_reference({good}, 1.25, wide, nan), InputError);
    for (const auto make : {+exact, brute_force_reference}) {
        for (const double g : {0.999, -1.0, nan, infinity}) {
            CHECK_THROWS_AS(make({good}, g, wide), InputError);
        }
        CHECK_THROWS_AS(make({good}, 1.25, {1, 1, -1, 0, 0, 0}), InputError);
        CHECK_THROWS_WITH(make({good, {Point(0, nan, 0), wide}}, 1.25, wide),
                          Catch::Contains("source 1") && Catch::Contains("position"));
        CHECK_THROWS_WITH(make({good, good, {Point::Zero(), {1, 1, 1, 2, 0, 0}}}, 1.25, wide),
                          Catch::Contains("source 2") && Catch::Contains("positive definite"));
    }
}

}  // namespace controlspace::reference_test
