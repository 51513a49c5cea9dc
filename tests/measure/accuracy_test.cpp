// SPDX-License-Identifier: Apache-2.0
#include "controlspace/measure/accuracy.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "controlspace/error.h"
#include "controlspace/fields/surface_fields.h"
#include "controlspace/measure/access_time.h"
#include "measure/fake_spaces.h"
#include "metric/draw.h"

namespace controlspace::accuracy_test {
namespace {

const Box cube{Point(-1, -1, -1), Point(1, 1, 1)};

double isotropic_delta(double k) { return std::sqrt(3.0) * (k + 1 / k - 2); }

FunctionSpace constant(const Metric& m) {
    return FunctionSpace([m](const Point&) { return m; });
}

Probes probes_of(std::vector<Point> points, const Metric& reference) {
    std::vector<Metric> references(points.size(), reference);
    return {std::move(points), std::move(references)};
}

// Answers 1 + x / 10000 times the unit metric: its errors at x = 1, 2, ... are known and distinct.
const FunctionSpace ramp([](const Point& p) { return Metric::isotropic(1 + p.x() / 10000); });
double ramp_delta(int x) { return isotropic_delta(1 + x / 10000.0); }

std::vector<Point> along_x(int n) {
    std::vector<Point> points;
    // 7919 is a prime that divides none of the numbers used: every x once, in a scattered order.
    for (int i = 0; i < n; ++i) points.emplace_back(1 + (i * 7919LL) % n, 0, 0);
    return points;
}

}  // namespace

TEST_CASE("Cell centres lie as the paper says, x fastest") {
    const auto points = cell_centres(cube, 30);
    REQUIRE(points.size() == 27000);
    CHECK(points[0] == Point::Constant(-1 + 2.0 / 60));
    CHECK(points[1].x() == -1 + 2.0 / 60 + 2.0 / 30);
    CHECK(points[1].y() == points[0].y());
    CHECK(points[30].y() == points[1].x());
    CHECK(points[900].z() == points[1].x());
    for (int k = 0; k < 30; ++k) {
        const double x = points[static_cast<std::size_t>(k)].x();
        CHECK(x == -1.0 + 2.0 / 60.0 + (k * 2.0) / 30.0);
        CHECK(x == Approx(-1 + 1.0 / 30 + k / 15.0).margin(1e-15));
    }
    CHECK(points.back().x() == Approx(1 - 1.0 / 30));
}

TEST_CASE("Cell centres of a box with unequal edges") {
    const auto points = cell_centres({Point(0, 10, 20), Point(4, 12, 21)}, 2);
    REQUIRE(points.size() == 8);
    CHECK(points[0] == Point(1, 10.5, 20.25));
    CHECK(points[7] == Point(3, 11.5, 20.75));
}

TEST_CASE("Cell centres need a sane number of cells") {
    CHECK_THROWS_AS(cell_centres(cube, 0), InputError);
    CHECK_THROWS_AS(cell_centres(cube, -3), InputError);
    CHECK_THROWS_AS(cell_centres(cube, 2000000000), InputError);
}

TEST_CASE("Probes carry the reference's own values") {
    const auto field = sphere_field({}).field;
    const Probes probes = make_probes(*field, cell_centres(cube, 3));
    REQUIRE(probes.reference.size() == 27);
    for (std::size_t i = 0; i < 27; ++i) {
        Metric expected;
        field->sample({&probes.points[i], 1}, {&expected, 1});
        CHECK(probes.reference[i] == expected);
    }
}

TEST_CASE("A space equal to its reference has no error") {
    const Metric m{0.3, 0.2, 0.5, 0.01, -0.02, 0.03};
    const Accuracy a = accuracy(constant(m), probes_of(cell_centres(cube, 20), m));
    CHECK(a.max < 1e-14);
    CHECK(a.riemannian_max < 1e-14);
}

TEST_CASE("A constant factor has the closed form's error everywhere") {
    const Accuracy a = accuracy(constant(Metric::isotropic(0.3)),
                                probes_of(cell_centres(cube, 20), Metric::isotropic(0.2)));
    for (const double delta : {a.max, a.mean, a.p95, a.p99}) {
        CHECK(delta == Approx(0.288675135));  // sqrt(3) (3/2 + 2/3 - 2)
    }
    CHECK(a.riemannian_max == Approx(isotropic_delta(2.25)));
    CHECK(a.worst == cell_centres(cube, 20).front());
}

TEST_CASE("Maximum, mean and percentiles by nearest rank of known errors") {
    for (const int n : {1, 19, 20, 100, 10000}) {
        const Accuracy a = accuracy(ramp, probes_of(along_x(n), Metric::isotropic(1)));
        const auto rank = [n](int percent) { return (n * percent + 99) / 100; };
        double mean = 0;
        for (int x = 1; x <= n; ++x) mean += ramp_delta(x) / n;
        CHECK(a.max == Approx(ramp_delta(n)));
        CHECK(a.mean == Approx(mean));
        CHECK(a.p95 == Approx(ramp_delta(rank(95))));
        CHECK(a.p99 == Approx(ramp_delta(rank(99))));
        CHECK(a.worst == Point(n, 0, 0));
    }
}

TEST_CASE("The first of several worst places is reported") {
    std::vector<Point> points = along_x(10000);
    points.emplace_back(10000, 1, 0);
    const Accuracy a = accuracy(ramp, probes_of(points, Metric::isotropic(1)));
    CHECK(a.worst == Point(10000, 0, 0));
}

TEST_CASE("Accuracy does not depend on the number of threads") {
    const auto field = sphere_field({}).field;
    const Probes probes = make_probes(*field, random_points(cube, 50000, 5));
    const FunctionSpace space([](const Point& p) {
        return Metric{0.1 + p.squaredNorm(), 0.2, 0.3 + p.x() * p.x(), 0.01, 0.02, 0.03};
    });
    const Accuracy many = accuracy(space, probes);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Accuracy single = accuracy(space, probes);
    CHECK(many.mean == single.mean);
    CHECK(many.max == single.max);
    CHECK(many.p99 == single.p99);
    CHECK(many.riemannian_max == single.riemannian_max);
    CHECK(many.worst == single.worst);
    CHECK(many.coarser_max == single.coarser_max);
    CHECK(many.coarser_share == single.coarser_share);
    CHECK(many.finer_max == single.finer_max);
    CHECK(many.finer_share == single.finer_share);
}

TEST_CASE("An answer that is no metric is infinitely wrong") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const FunctionSpace broken([nan](const Point& p) {
        return p.x() == 3 ? Metric{nan, 1, 1, 0, 0, 0} : Metric::isotropic(1);
    });
    const Accuracy a = accuracy(broken, probes_of(along_x(10), Metric::isotropic(1)));
    CHECK(a.max == infinity);
    CHECK(a.riemannian_max == infinity);
    CHECK(a.worst == Point(3, 0, 0));
    CHECK(a.coarser_max == infinity);
    CHECK(a.coarser_share == Approx(0.1));
    CHECK(a.finer_max == infinity);
    CHECK(a.finer_share == Approx(0.1));
    const std::vector<PointSource> sources{{Point(3, 0, 0), Metric::isotropic(1)}};
    CHECK(source_accuracy(broken, sources) == infinity);
}

TEST_CASE("Larger elements than asked for are counted apart from smaller ones") {
    const Metric asked = Metric::isotropic(1);
    const auto errors = [&](const Metric& answer) {
        return accuracy(constant(answer), probes_of(along_x(5000), asked));
    };
    CHECK(errors(asked).coarser_share == 0);
    CHECK(errors(asked).coarser_max == 1);
    CHECK(errors(0.5 * asked).coarser_share == 0);
    CHECK(errors(0.5 * asked).coarser_max == 0.5);
    CHECK(errors(3 * asked).coarser_share == 1);
    CHECK(errors(3 * asked).coarser_max == 3);
    // One direction is enough, however small the others are.
    CHECK(errors({0.1, 0.1, 2, 0, 0, 0}).coarser_share == 1);
    CHECK(errors({0.1, 0.1, 2, 0, 0, 0}).coarser_max == 2);
    CHECK(errors(1.0099 * asked).coarser_share == 0);
    CHECK(errors(1.0101 * asked).coarser_share == 1);
}

TEST_CASE("The ratio of lengths is the largest over all directions") {
    Draw draw(31);
    for (int i = 0; i < 20; ++i) {
        const Metric held = draw.metric(1, 10);
        const Metric asked = draw.metric(1, 10);
        const double k = accuracy(constant(held), probes_of(along_x(3), asked)).coarser_max;
        // |asked^-1 d| / |held^-1 d| over all d.
        const Eigen::Matrix3d a = asked.matrix().inverse();
        const Eigen::Matrix3d h = held.matrix().inverse();
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> squares(a * a, h * h);
        CHECK(k == Approx(std::sqrt(squares.eigenvalues()[2])));
        for (int j = 0; j < 100; ++j) {
            const Vector d = draw.vector();
            CHECK(metric_length(asked, d) <= k * (1 + 1e-9) * metric_length(held, d));
        }
    }
}

TEST_CASE("Smaller lengths are counted as larger ones of the reference are") {
    Draw draw(32);
    for (int i = 0; i < 20; ++i) {
        const Metric a = draw.metric(1, 3);
        const Metric b = draw.metric(1, 3);
        const Accuracy of_a = accuracy(constant(a), probes_of(along_x(3), b));
        const Accuracy of_b = accuracy(constant(b), probes_of(along_x(3), a));
        CHECK(of_a.finer_max == of_b.coarser_max);
        CHECK(of_a.finer_share == of_b.coarser_share);
    }
}

TEST_CASE("The share is that of the places, over blocks of any size") {
    for (const int n : {1, 100, 10000}) {
        const Accuracy a = accuracy(ramp, probes_of(along_x(n), Metric::isotropic(1)));
        CHECK(a.coarser_max == Approx(1 + n / 10000.0));
        CHECK(a.coarser_share == Approx(std::max(0, n - 100) / static_cast<double>(n)));
    }
}

TEST_CASE("Accuracy at no places is refused") {
    CHECK_THROWS_AS(accuracy(ramp, Probes{}), InputError);
}

TEST_CASE("Source accuracy is the largest error at the sources' places") {
    std::vector<PointSource> sources;
    for (const Point& p : along_x(10000)) sources.push_back({p, Metric::isotropic(1)});
    CHECK(source_accuracy(ramp, sources) == Approx(ramp_delta(10000)));
    sources.push_back({Point(0, 0, 0), Metric::isotropic(4)});
    CHECK(source_accuracy(ramp, sources) == Approx(isotropic_delta(4)));
    CHECK(source_accuracy(ramp, {}) == 0);
}

}  // namespace controlspace::accuracy_test
