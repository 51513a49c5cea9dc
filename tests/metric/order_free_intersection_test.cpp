// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/order_free_intersection.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <future>
#include <limits>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "counting_allocator.h"
#include "metric/draw.h"
#include "metric/largest_within.h"

namespace controlspace::order_free_intersection_test {
namespace {

using Metrics = std::vector<Metric>;

struct Case {
    std::string name;
    Metrics metrics;
    double anisotropy;
    /// Of squared lengths; what rounding of six numbers may make of them.
    double rounding() const { return 1e-13 + 4e-14 * anisotropy; }
};

Metrics drawn(Draw& draw, std::size_t count, double anisotropy, double sizes = 2) {
    Metrics metrics;
    for (std::size_t i = 0; i < count; ++i) {
        metrics.push_back(draw.metric(draw.uniform(1, sizes), anisotropy));
    }
    return metrics;
}

// 1 across, `anisotropy` along, at right angles to any direction: all touch at the answer.
Metrics layers(Draw& draw, std::size_t count, double anisotropy) {
    Metrics metrics;
    for (std::size_t i = 0; i < count; ++i) {
        metrics.push_back(layer_metric(draw.vector().normalized(), 1, anisotropy));
    }
    return metrics;
}

std::vector<Case> cases() {
    Draw draw(41);
    std::vector<Case> all;
    for (const double anisotropy : {1.5, 10.0, 1e3, 1e6}) {
        const auto add = [&](const std::string& name, const Metrics& metrics) {
            all.push_back({name, metrics, anisotropy});
        };
        for (const std::size_t count : {3, 5, 12, 16, 17, 60}) {
            add("drawn", drawn(draw, count, anisotropy));
            add("of many sizes", drawn(draw, count, anisotropy, 100));
        }
        for (const std::size_t count : {4, 30, 1000})
            add("layers", layers(draw, count, anisotropy));
        const Metric m = draw.metric(1, anisotropy);
        add("equal", Metrics(20, m));
        for (const double level : {1e-12, 1e-6, 1e-2}) {
            Metrics near(9, m);
            for (Metric& n : near) {
                n = Metric::from_matrix(n.matrix() +
                                        level / anisotropy * draw.metric(1, 3).matrix());
            }
            add("nearly equal", near);
        }
        Metrics eight = drawn(draw, 8, anisotropy);
        for (const Metric& large : drawn(draw, 992, anisotropy)) {
            eight.push_back(5 * anisotropy * large);
        }
        std::rotate(eight.begin(), eight.begin() + 500, eight.end());
        add("a thousand of which eight matter", eight);
        add("with isotropic ones", drawn(draw, 6, anisotropy));
        all.back().metrics.push_back(Metric::isotropic(0.9));
        all.back().metrics.push_back(Metric::isotropic(1.1));
    }
    return all;
}

Metrics shuffled(Metrics metrics, unsigned seed) {
    std::shuffle(metrics.begin(), metrics.end(), std::mt19937(seed));
    return metrics;
}

// Largest difference of a length along any direction that a gap allows: the answers Y <= B_k and
// Y' of gaps up to g have their mean within all B_k too, so log det of it is at most g larger.
double lengths_within(double gap) { return 2 * std::sqrt(gap) + 1e-13; }

double log_det_square(const Metric& m) { return 2 * std::log(m.matrix().determinant()); }

}  // namespace

TEST_CASE(
    "order-free intersection: within every metric, with a certificate that it is the largest") {
    const double tolerance = GENERATE(1e-2, 1e-6, 1e-10);
    for (const Case& c : cases()) {
        CAPTURE(c.name, c.metrics.size(), c.anisotropy, tolerance);
        const OrderFreeIntersection answer = order_free_intersection(c.metrics, tolerance);
        CHECK(excess(answer, c.metrics) <= 1 + c.rounding());
        CHECK(answer.gap <= std::max(tolerance, c.rounding()));
        CHECK(proven_gap(answer, c.metrics) <= answer.gap + c.rounding() + 1e-11);
        const Metric m = answer.metric();
        CHECK(is_positive_definite(m));
        for (const Metric& other : c.metrics) CHECK(is_within(m, 1, other));
    }
}

TEST_CASE(
    "order-free intersection: rounding is what the header states, up to its largest anisotropy") {
    const double anisotropy = GENERATE(1e2, 1e4, 1e6, 1e7, 5e7);
    const double rounding = 2e-14 * anisotropy * (1 + anisotropy / 1e6);
    const double tolerance = GENERATE(1e-6, 1e-10);
    Draw draw(51);
    std::size_t answers = 0;
    for (int i = 0; i < 100; ++i) {
        for (const std::size_t count : {2, 3, 5, 12, 40}) {
            Metrics close;  // layers that are nearly parallel
            for (std::size_t k = 0; k < count; ++k) {
                const Vector normal = (Vector(1, 2, 3) + 1e-3 * draw.vector()).normalized();
                close.push_back(layer_metric(normal, 1, anisotropy));
            }
            for (const Metrics& metrics :
                 {drawn(draw, count, anisotropy), drawn(draw, count, anisotropy, 100),
                  layers(draw, count, anisotropy), close}) {
                CAPTURE(anisotropy, tolerance, count, i);
                OrderFreeIntersection answer;
                try {
                    answer = order_free_intersection(metrics, tolerance);
                } catch (const InputError&) {  // of lengths that rounding hides
                    CHECK(anisotropy > 1e7);
                    continue;
                }
                ++answers;
                const LongMatrix m = long_matrix(answer.metric());
                long double longest = 0;
                for (const Metric& other : metrics) {
                    const LongMatrix k = long_matrix(other).inverse() * m;
                    longest = std::max(longest, LongSolver(k.transpose() * k).eigenvalues()[2]);
                }
                CHECK(std::sqrt(longest) <= 1 + rounding);
                CHECK(answer.gap <= tolerance + rounding);
                CHECK(proven_gap(answer, metrics) <= answer.gap + rounding);
            }
        }
    }
    CHECK(answers >= 400);
}

TEST_CASE("order-free intersection: agrees with a solver that works in another way") {
    Draw draw(42);
    for (int i = 0; i < 60; ++i) {
        const double anisotropy = std::pow(10, draw.uniform(0, 2));
        const Metrics metrics = drawn(draw, static_cast<std::size_t>(3 + i % 12), anisotropy);
        const LongMatrix best = LargestWithin(metrics).square();
        const OrderFreeIntersection answer = order_free_intersection(metrics, 1e-10);
        const auto log_det = static_cast<double>(std::log(best.determinant()));
        CHECK(log_det_square(answer) == Approx(log_det).margin(1e-9));
        const Metric m =
            Metric::from_matrix(LongSolver(best).operatorSqrt().template cast<double>());
        CHECK(length_difference(answer.metric(), m) < 1e-4);
    }
}

TEST_CASE("order-free intersection: of two metrics it is their intersection") {
    Draw draw(43);
    for (const double anisotropy : {1.0, 1 + 1e-9, 5.0, 1e3, 1e6}) {
        for (int i = 0; i < 40; ++i) {
            const Metrics pair{draw.metric(1, anisotropy),
                               draw.metric(draw.uniform(0.3, 3), anisotropy)};
            const OrderFreeIntersection answer = order_free_intersection(pair);
            const Metrics turned{pair[1], pair[0]};
            CHECK(order_free_intersection(turned).metric() == answer.metric());
            CHECK(answer.gap == 0);
            CHECK(proven_gap(answer, pair) <= 1e-13 + 1e-14 * anisotropy);
            CHECK(length_difference(answer.metric(), intersection(pair[0], pair[1])) <=
                  1e-14 + 8e-15 * anisotropy);
        }
    }
}

TEST_CASE("order-free intersection: of metrics along the axes, the smallest length along each") {
    Draw draw(50);
    const auto length = [&] { return std::floor(draw.uniform(1, 5)); };  // equal ones, too
    for (int i = 0; i < 3000; ++i) {
        Metrics metrics;
        Metric least = Metric::isotropic(5);
        for (int k = 0; k < 2 + i % 30; ++k) {
            metrics.push_back({length(), length(), length(), 0, 0, 0});
            least.xx = std::min(least.xx, metrics.back().xx);
            least.yy = std::min(least.yy, metrics.back().yy);
            least.zz = std::min(least.zz, metrics.back().zz);
        }
        const Metric m = order_free_intersection(metrics).metric();
        CAPTURE(i, m, least);
        REQUIRE(is_positive_definite(m));
        CHECK(length_difference(m, least) <= (metrics.size() == 2 ? 1e-14 : lengths_within(1e-6)));
        CHECK(order_free_intersection(shuffled(metrics, 7)).metric() == m);
    }
}

TEST_CASE("order-free intersection: a metric within all others is the answer, to the bit") {
    Draw draw(44);
    Metrics isotropic;
    for (int i = 0; i < 30; ++i) isotropic.push_back(Metric::isotropic(draw.uniform(0.1, 9)));
    isotropic.push_back(Metric::isotropic(0.05));
    CHECK(order_free_intersection(shuffled(isotropic, 1)).metric() == Metric::isotropic(0.05));
    for (const double anisotropy : {1.0, 30.0, 1e6}) {
        const Metric m = draw.metric(1, anisotropy);
        Metrics metrics{m};
        CHECK(order_free_intersection(metrics).metric() == m);
        for (int i = 0; i < 20; ++i) {
            metrics.push_back(draw.uniform(1.1, 3) * anisotropy * draw.metric(1, anisotropy));
        }
        metrics.push_back(m);
        CHECK(order_free_intersection(shuffled(metrics, 2)).metric() == m);
    }
}

TEST_CASE("order-free intersection: no larger than by any order of intersecting in turn") {
    for (const Case& c : cases()) {
        if (c.anisotropy > 1e3 || c.metrics.size() > 100) continue;
        CAPTURE(c.name, c.metrics.size(), c.anisotropy);
        const double best = log_det_square(order_free_intersection(c.metrics));
        for (const unsigned seed : {1u, 2u, 3u}) {
            const Metrics order = shuffled(c.metrics, seed);
            Metric in_turn = order[0];
            for (const Metric& m : order) in_turn = intersection(in_turn, m);
            CHECK(best >= log_det_square(in_turn) - 1e-6 - c.rounding());
        }
    }
}

TEST_CASE("order-free intersection: one metric more never makes the determinant larger") {
    Draw draw(45);
    for (int round = 0; round < 20; ++round) {
        const Metrics metrics = drawn(draw, 24, 30);
        double before = std::numeric_limits<double>::infinity();
        for (std::size_t count = 1; count <= metrics.size(); ++count) {
            const auto answer = order_free_intersection(std::span(metrics).first(count), 1e-8);
            CHECK(log_det_square(answer) <= before + 1e-8);
            before = log_det_square(answer);
        }
    }
}

TEST_CASE("order-free intersection: the same bits in any order and from any thread") {
    for (const Case& c : cases()) {
        CAPTURE(c.name, c.metrics.size(), c.anisotropy);
        const Metric answer = order_free_intersection(c.metrics).metric();
        CHECK(order_free_intersection(shuffled(c.metrics, 5)).metric() == answer);
        const Metrics other = shuffled(c.metrics, 6);
        CHECK(std::async(std::launch::async, [&] {
                  return order_free_intersection(other).metric();
              }).get() == answer);
    }
}

TEST_CASE("order-free intersection: scales with the metrics, and is covariant") {
    Draw draw(46);
    constexpr double tolerance = 1e-10;
    for (const Case& c : cases()) {
        if (c.metrics.size() > 100) continue;
        CAPTURE(c.name, c.metrics.size(), c.anisotropy);
        const OrderFreeIntersection answer = order_free_intersection(c.metrics, tolerance);
        for (const double k : {1e-9, 0.3048, 1e9}) {
            Metrics scaled;
            for (const Metric& m : c.metrics) scaled.push_back(k * m);
            const auto of_scaled = order_free_intersection(scaled, tolerance);
            CHECK(log_det_square(of_scaled) - 6 * std::log(k) ==
                  Approx(log_det_square(answer)).margin(2 * tolerance + c.rounding()));
        }
        if (c.anisotropy > 1e3) continue;
        // A stretch, and all 48 symmetries of the axes.
        Eigen::Matrix3d stretch = Eigen::Matrix3d::Random() + 3 * draw.rotation();
        std::vector<Eigen::Matrix3d> maps{stretch};
        Eigen::PermutationMatrix<3> exchange(Eigen::Vector3i(1, 2, 0));
        Eigen::Matrix3d swap;
        swap << 0, 1, 0, 1, 0, 0, 0, 0, -1;
        maps.emplace_back(Eigen::Matrix3d(exchange));
        maps.push_back(swap);
        maps.emplace_back(Vector(-1, 1, 1).asDiagonal());
        for (const Eigen::Matrix3d& a : maps) {
            Metrics mapped;
            for (const Metric& m : c.metrics) mapped.push_back(left_polar_factor(a * m.matrix()));
            const Metric of_mapped = order_free_intersection(mapped, tolerance).metric();
            CHECK(length_difference(of_mapped, left_polar_factor(a * answer.factor)) <
                  lengths_within(tolerance) + 1e-11 * c.anisotropy);
        }
    }
}

TEST_CASE("order-free intersection: of cones it obeys the gradation law") {
    // B_i(p) = (f_i M_i)^2, f_i = 1 + (g-1) |M_i^-1 (p - Q_i)|. With e = (g-1) |M(p)^-1 v|, no
    // B_i grows by more than (1+e)^2 from p to p + v, nor shrinks by more than (1-e)^2.
    Draw draw(47);
    constexpr double g = 1.25;
    constexpr double tolerance = 1e-9;
    for (int round = 0; round < 40; ++round) {
        const Metrics metrics = drawn(draw, 20, 20);
        std::vector<Point> positions;
        for (std::size_t i = 0; i < metrics.size(); ++i) positions.push_back(3 * draw.vector());
        const auto field = [&](const Point& p) {
            Metrics cones;
            for (std::size_t i = 0; i < metrics.size(); ++i) {
                const double f = 1 + (g - 1) * metric_length(metrics[i], p - positions[i]);
                cones.push_back(f * metrics[i]);
            }
            return order_free_intersection(cones, tolerance);
        };
        const Point p = 2 * draw.vector();
        const OrderFreeIntersection here = field(p);
        for (const double step : {1e-3, 0.1, 1.0}) {
            const Vector v = step * draw.vector();
            const double e = (g - 1) * metric_length(here.metric(), v);
            if (e >= 1) continue;
            const double change = log_det_square(field(p + v)) - log_det_square(here);
            CHECK(change <= 6 * std::log(1 + e) + tolerance);
            CHECK(change >= 6 * std::log(1 - e) - tolerance);
        }
    }
}

TEST_CASE("order-free intersection: a start nearby saves steps and changes nothing else") {
    Draw draw(48);
    for (const Case& c : cases()) {
        CAPTURE(c.name, c.metrics.size(), c.anisotropy);
        const OrderFreeIntersection answer = order_free_intersection(c.metrics);
        for (const double level : {0.0, 1e-4, 5e-3, 0.3, 1.0, 1e3}) {
            CAPTURE(level);
            Eigen::Matrix3d near = answer.factor;
            for (int i = 0; i < 3; ++i) near.col(i) += level * (answer.factor * draw.vector());
            const auto again = order_free_intersection(c.metrics, 1e-6, &near);
            CHECK(excess(again, c.metrics) <= 1 + c.rounding());
            CHECK(again.gap <= std::max(1e-6, c.rounding()));
            CHECK(proven_gap(again, c.metrics) <= again.gap + c.rounding() + 1e-11);
        }
    }
    const Metrics twelve = drawn(draw, 12, 30);
    const OrderFreeIntersection cold = order_free_intersection(twelve);
    const OrderFreeIntersection warm = order_free_intersection(twelve, 1e-6, &cold.factor);
    CHECK(2 * warm.steps <= cold.steps);
    for (const double number : {0.0, 1e200, std::nan("")}) {
        const Eigen::Matrix3d nonsense = Eigen::Matrix3d::Constant(number);
        CHECK(order_free_intersection(twelve, 1e-6, &nonsense).metric() == cold.metric());
    }
}

TEST_CASE("order-free intersection: allocates nothing") {
    const std::vector<Case> all = cases();
    for (const Case& c : all) {
        const std::size_t before = live_bytes();
        reset_peak_bytes();
        const OrderFreeIntersection answer = order_free_intersection(c.metrics);
        const std::size_t peak = peak_bytes();
        CHECK(peak == before);
        CHECK(answer.count > 0);
    }
}

TEST_CASE("order-free intersection: bad input is refused, and its place named") {
    using Catch::Contains;
    const double nan = std::nan("");
    const double infinite = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(order_free_intersection({}), Contains("no metrics") && Contains("give"));
    Draw draw(49);
    for (const std::size_t place : {0u, 4u, 17u}) {
        const std::string name = "metric " + std::to_string(place);
        const auto check = [&](const Metric& bad, const std::string& reason) {
            Metrics metrics = drawn(draw, 20, 10);
            metrics[place] = bad;
            CHECK_THROWS_AS(order_free_intersection(metrics), InputError);
            CHECK_THROWS_WITH(order_free_intersection(metrics),
                              Contains(name + ",") && Contains(reason));
        };
        for (const Metric& bad : {Metric{0, 0, 0, 0, 0, 0}, Metric{1, 1, -1, 0, 0, 0},
                                  Metric{1, 1, 1, 2, 0, 0}, Metric{1, 1, 1, 0, nan, 0},
                                  Metric{nan, 1, 1, 0, 0, 0}, Metric{infinite, 1, 1, 0, 0, 0}}) {
            check(bad, "positive definite");
        }
        check({1e9, 1, 1, 0, 0, 0}, "anisotropy");
        check({1e12, 1e3, 1, 0, 0, 0}, "anisotropy");
        check(Metric::isotropic(1e90), "unit of length");
        check(Metric::isotropic(1e-90), "unit of length");
    }
}

}  // namespace controlspace::order_free_intersection_test
