// SPDX-License-Identifier: Apache-2.0
#include "metric/running_intersection.h"

#include <catch2/catch.hpp>

#include "controlspace/metric/intersection.h"
#include "metric/draw.h"

namespace controlspace::running_intersection_test {
namespace {

// `count` metrics, the ones that come later within each other by less and less.
std::vector<Metric> metrics(Draw& draw, int count, double anisotropy) {
    std::vector<Metric> list;
    for (int i = 0; i < count; ++i) {
        list.push_back(draw.metric(std::pow(10, draw.uniform(0, 1)), anisotropy));
    }
    return list;
}

}  // namespace

TEST_CASE("A running intersection is the repeated one") {
    const double anisotropy = GENERATE(1.0, 1.001, 3.0, 30.0, 1000.0, 1e5);
    Draw draw(1);
    int steps_that_count = 0;
    for (int round = 0; round < 50; ++round) {
        const Metric first = round % 2 == 0 ? Metric::isotropic(5) : draw.metric(5, anisotropy);
        RunningIntersection running(first);
        Metric wanted = first;
        for (const Metric& m : metrics(draw, 60, anisotropy)) {
            const Metric next = intersection(wanted, m);
            REQUIRE(running.shorten_to(m) == (next != wanted));
            steps_that_count += next != wanted ? 1 : 0;
            wanted = next;
            const Metric now = running.metric();
            REQUIRE(length_difference(now, wanted) < 2e-14 * anisotropy);
            REQUIRE(length_difference(running.square(), square(wanted)) <
                    1e-13 * anisotropy * anisotropy);
            REQUIRE(running.longest() >= eigen_frame(now).lengths[2] * (1 - 1e-14 * anisotropy));
        }
    }
    CHECK(steps_that_count > 50);
}

TEST_CASE("A running intersection follows thousands of small cuts") {
    Draw draw(2);
    RunningIntersection running(Metric::isotropic(1));
    Metric wanted = Metric::isotropic(1);
    // Flat metrics that turn little by little: each cuts a little off the one before.
    const Eigen::Matrix3d frame = draw.rotation();
    int steps = 0;
    for (int i = 0; i < 3000; ++i) {
        const double a = 1e-4 * i;
        Eigen::Matrix3d turn;
        turn << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
        const Metric m = metric_from_frame({0.02, 0.3, 0.5}, frame * turn);
        steps += running.shorten_to(m) ? 1 : 0;
        wanted = intersection(wanted, m);
    }
    CHECK(steps == 3000);
    CHECK(length_difference(running.metric(), wanted) < 1e-12);
}

TEST_CASE("A running intersection of which nothing is cut stays to the bit") {
    Draw draw(3);
    for (int i = 0; i < 100; ++i) {
        const Metric first = draw.metric(1, 20);
        RunningIntersection running(first);
        CHECK_FALSE(running.shorten_to(first));
        CHECK_FALSE(running.shorten_to(1.001 * first));
        CHECK_FALSE(running.shorten_to(Metric::isotropic(20)));
        CHECK(running.metric() == first);
    }
}

TEST_CASE("A running intersection is cut along one, two and three directions") {
    Draw draw(4);
    for (int i = 0; i < 100; ++i) {
        const Eigen::Matrix3d frame = draw.rotation();
        RunningIntersection running(metric_from_frame({1, 2, 3}, frame));
        const auto reached = [&](const std::array<double, 3>& lengths) {
            return length_difference(running.metric(), metric_from_frame(lengths, frame)) < 1e-14;
        };
        CHECK(running.shorten_to(metric_from_frame({4, 4, 2.5}, frame)));
        CHECK(reached({1, 2, 2.5}));
        CHECK(running.shorten_to(metric_from_frame({4, 1.5, 2}, frame)));
        CHECK(reached({1, 1.5, 2}));
        CHECK(running.shorten_to(metric_from_frame({0.5, 0.6, 0.7}, frame)));
        CHECK(reached({0.5, 0.6, 0.7}));
        CHECK(running.shorten_to(Metric::isotropic(1e-6)));
        CHECK(reached({1e-6, 1e-6, 1e-6}));
    }
}

}  // namespace controlspace::running_intersection_test
