// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "baselines/fixtures.h"
#include "baselines/octree_scenes.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/input_errors.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_nodes.h"
#include "counting_allocator.h"

namespace controlspace::openvdb_bricks_test {

using octree_scenes::g, octree_scenes::Scene;

namespace {

// Anywhere, near sources, and on the faces of cells and beside them.
std::vector<Point> places(const Scene& scene, const ControlSpace& space) {
    std::vector<Point> x = random_points(scene.domain, 30000, 1);
    const std::vector<Point> ways = random_points({-Vector::Ones(), Vector::Ones()}, 200, 2);
    for (const PointSource& source : scene.sources) {
        x.push_back(source.position);
        for (const Vector& way : ways) {
            x.push_back(nearest_in(scene.domain, source.position + source.metric.xx * way));
        }
    }
    for (std::size_t i = 0; i < 300; ++i) {
        const Box cell = space.cell_at(x[i]).value();
        for (Axis a = 0; a < 3; ++a) {
            for (const double face : {cell.low[a], cell.high[a]}) {
                for (const double beside : {-1e9, face, 1e9}) {
                    Point p = x[i];
                    p[a] = std::nextafter(face, beside);
                    x.push_back(nearest_in(scene.domain, p));
                }
            }
        }
    }
    return x;
}

// The box of 4^3 cells, or 4^2, that holds this one; cells are of one size from some level on.
Box brick_of(const Box& cell, const Box& domain) {
    Box brick = cell;
    for (Axis a = 0; a < 3; ++a) {
        const double edge = 4 * cell.edges()[a];
        if (edge == 0) continue;
        const double number = std::floor((cell.centre()[a] - domain.low[a]) / edge);
        brick.low[a] = domain.low[a] + number * edge;
        brick.high[a] = brick.low[a] + edge;
    }
    return brick;
}

// That of codes of 8 bits in trees, as a factor.
double half_step(const ControlSpace& space) {
    const auto nodes = control_nodes(space, Neighbourhood::faces).value().metrics;
    const auto [shortest, longest] = std::ranges::minmax(nodes, {}, &Metric::xx);
    return std::pow(longest.xx / shortest.xx, 1.0 / 510);
}

}  // namespace

TEST_CASE("what is read from bricks keeps the target everywhere, in every precision") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2, 3));
    CAPTURE(scene.domain);
    constexpr double target = 0.1;
    for (const Precision precision :
         {Precision::doubles, Precision::floats, Precision::log16, Precision::log8}) {
        CAPTURE(static_cast<int>(precision));
        const auto space =
            scene.builder("openvdb-bricks", target, precision)->build({.precision = precision});
        const std::vector<Point> x = places(scene, *space);
        std::vector<double> lengths(x.size());
        space->sample_lengths(x, lengths);
        double worst = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            REQUIRE(space->length_at(x[i]) == lengths[i]);
            worst = std::max(worst, nonconformity(Metric::isotropic(lengths[i]),
                                                  Metric::isotropic(scene.exact(x[i]))));
        }
        CHECK(worst <= target);
        CHECK(worst > 0.3 * target);
    }
}

TEST_CASE("cells fill bricks, and answers in a cell are trilinear between its corners") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2));
    CAPTURE(scene.domain);
    const bool is_flat = scene.domain.edges().minCoeff() == 0;
    const auto builder = scene.builder("openvdb-bricks", 0.1, Precision::doubles);
    const auto made = builder->build();
    const auto space = builder->build({.precision = Precision::doubles});
    for (const Point& x : random_points(scene.domain, 500, 3)) {
        const Box cell = made->cell_at(x).value();
        REQUIRE(space->cell_at(x).value() == cell);
        REQUIRE(cell.contains(x));
        const Box brick = brick_of(cell, scene.domain);
        for (const Point& y : random_points(brick, 10, 4)) {
            const Vector other = made->cell_at(y).value().edges();
            REQUIRE((other - cell.edges()).norm() <= 1e-9 * cell.edges().norm());
        }
        // Corners belong to this cell from within.
        const Vector t = (x - cell.low).cwiseQuotient(divisible_edges(cell));
        double sum = 0;
        for (int c = 0; c < 8; ++c) {
            double weight = 1;
            for (Axis a = 0; a < 3; ++a) weight *= (c >> a & 1) != 0 ? t[a] : 1 - t[a];
            const Point inside = corner(cell, c) + 1e-9 * (cell.centre() - corner(cell, c));
            sum += weight * space->length_at(inside);
        }
        REQUIRE(space->length_at(x) == Approx(sum).epsilon(1e-7));
        REQUIRE(made->length_at(x) == space->length_at(x));
    }
    const std::size_t cells = made->footprint().cells;
    CHECK(cells % (is_flat ? 16 : 64) == 0);
    CHECK(space->footprint().cells == cells);
    CHECK(made->footprint().control_nodes ==
          control_nodes(*space, Neighbourhood::faces).value().metrics.size());
}

TEST_CASE("codes of bricks round by half a step of their own range, and by what they say") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2));
    CAPTURE(scene.domain);
    const auto builder = scene.builder("openvdb-bricks", 0.1, Precision::log8);
    const auto exact = builder->build({.precision = Precision::doubles});
    const auto codes = builder->build({.precision = Precision::log8});
    double most = 1;
    for (const Point& x : random_points(scene.domain, 3000, 3)) {
        const Box cell = exact->cell_at(x).value();
        const Box brick = brick_of(cell, scene.domain);
        double shortest = exact->length_at(x), longest = shortest;
        for (int i = 0; i < 125; ++i) {
            const Vector share(0.25 * (i % 5), 0.25 * (i / 5 % 5), 0.25 * (i / 25));
            const Point at = brick.low + share.cwiseProduct(brick.edges());
            const Point inside = at + 1e-6 * (brick.centre() - at);
            shortest = std::min(shortest, exact->length_at(inside));
            longest = std::max(longest, exact->length_at(inside));
        }
        const double factor = largest_ratio(exact->metric_at(x), codes->metric_at(x));
        // Steps are up to 1.05 times as long as they would have to be.
        REQUIRE(factor <= 1 + 1.05 * (longest / shortest - 1) / 510 + 1e-6);
        most = std::max(most, factor);
    }
    CHECK(most <= half_step(*exact));
    CHECK(most > 1.0003);
}

TEST_CASE("lengths of many orders in one brick are kept in more bits") {
    // Not graded: at one place a millionth of what is asked for beside it.
    const auto builder =
        structure_with_id("openvdb-bricks")
            .make({.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .finest_length = 1e-6});
    builder->insert(std::vector<PointSource>{{Point(0.3, 0.2, 0.1), Metric::isotropic(1e-6)},
                                             {Point(-0.7, 0.2, 0.1), Metric::isotropic(0.1)}});
    const auto exact = builder->build({.precision = Precision::doubles});
    for (const Precision precision : {Precision::log16, Precision::log8}) {
        const auto codes = builder->build({.precision = precision});
        std::vector<Point> x = random_points(codes->domain(), 5000, 1);
        for (const Point& way : random_points({-Vector::Ones(), Vector::Ones()}, 5000, 2)) {
            x.emplace_back(Point(0.3, 0.2, 0.1) + 3e-6 * way);
        }
        std::vector<double> lengths(x.size());
        codes->sample_lengths(x, lengths);
        double most = 1, least = 1;
        for (std::size_t i = 0; i < x.size(); ++i) {
            REQUIRE(codes->length_at(x[i]) == lengths[i]);
            most = std::max(most, largest_ratio(exact->metric_at(x[i]), codes->metric_at(x[i])));
            least = std::min(least, lengths[i]);
        }
        const double of_trees =
            precision == Precision::log8 ? half_step(*exact) : std::sqrt(1.0002);
        CHECK(most <= of_trees * (1 + 1e-12));
        CHECK(least < 2e-6);
    }
}

TEST_CASE("tensors in bricks are positive definite, in floats to some 1e-6") {
    const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .finest_length = 1};
    const std::vector<PointSource> sources = sample_sphere({.h = 0.3, .s_a = 2, .s_n = 0.2});
    const auto builder = structure_with_id("openvdb-bricks").make(options);
    AdaptationGoal goal{sources, nullptr, g, 1};
    CHECK(builder->adapt(goal).met);
    const auto exact = builder->build();
    const auto floats = builder->build({.precision = Precision::floats});
    for (const Point& x : random_points(options.domain, 5000, 1)) {
        REQUIRE(is_positive_definite(floats->metric_at(x)));
        REQUIRE(nonconformity(floats->metric_at(x), exact->metric_at(x)) < 1e-6);
    }
    CHECK_THROWS_AS(builder->build({.precision = Precision::log8}), InputError);
}

TEST_CASE("bricks take the memory that they say") {
    const Scene scene = octree_scenes::scene(0);
    const auto builder = scene.builder("openvdb-bricks", 0.1, Precision::log8);
    for (const Precision precision : {Precision::doubles, Precision::floats, Precision::log8}) {
        CAPTURE(static_cast<int>(precision));
        const std::size_t before = live_bytes();
        const auto space = builder->build({.precision = precision});
        const std::size_t taken = live_bytes() - before;
        const std::size_t counted = space->footprint().bytes_total();
        // OpenVDB does not count some 16 bytes a block; the recipe is beside.
        CHECK(taken >= counted);
        CHECK(taken <= counted + 5000);
    }
    const auto floats = builder->build({.precision = Precision::floats})->footprint();
    const auto codes = builder->build({.precision = Precision::log8})->footprint();
    CHECK(2.2 * static_cast<double>(codes.bytes_total()) <
          static_cast<double>(floats.bytes_total()));
}

TEST_CASE("bricks beyond the child of the root are told, and those beyond memory refused") {
    const Scene scene = octree_scenes::far_below_the_root();
    const auto builder = scene.builder("openvdb-bricks", 0.5, Precision::floats);
    const auto space = builder->build({.precision = Precision::floats});
    CHECK_THAT(space->footprint().remark, Catch::Contains("upper nodes"));
    double worst = 0;
    for (const Point& x : places(scene, *space)) {
        worst =
            std::max(worst, nonconformity(space->metric_at(x), Metric::isotropic(scene.exact(x))));
    }
    CHECK(worst <= 0.5);
    const std::size_t bytes = space->footprint().bytes_total();
    SpaceOptions options = scene.options();
    options.max_bytes = bytes - bytes / 10;
    const auto small = structure_with_id("openvdb-bricks").make(options);
    const auto build = [&] {
        (void)small->adapt({scene.sources, nullptr, g, 0.5});
        (void)small->build({.precision = Precision::floats});
    };
    CHECK_THROWS_AS(build(), MemoryLimitError);
}

TEST_CASE("bricks are cut whole, as far as the leaves that are allowed reach") {
    const Scene scene = octree_scenes::scene(0);
    const auto builder = structure_with_id("openvdb-bricks").make(scene.options());
    AdaptationGoal goal{scene.sources, nullptr, g, 0.05};
    goal.max_leaves = 3000;
    const AdaptationReport report = builder->adapt(goal);
    CHECK_FALSE(report.met);
    CHECK(report.stop == GrowthStop::leaves);
    const std::size_t cells = builder->build()->footprint().cells;
    CHECK(cells <= goal.max_leaves);
    CHECK(cells > goal.max_leaves - 8 * 64);
    CHECK(cells % 64 == 0);
}

}  // namespace controlspace::openvdb_bricks_test
