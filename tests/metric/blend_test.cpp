// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/blend.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "metric/draw.h"

namespace controlspace::blend_test {
namespace {

std::vector<double> random_weights(Draw& draw, std::size_t n) {
    std::vector<double> weights(n);
    double sum = 0;
    for (double& w : weights) sum += w = draw.uniform(0, 1);
    for (double& w : weights) w /= sum;
    return weights;
}

Metric blended(const std::vector<double>& weights, const std::vector<Metric>& metrics) {
    return blend_lengths(weights, [&](std::size_t i) -> const Metric& { return metrics[i]; });
}

}  // namespace

TEST_CASE("a blend reproduces a constant") {
    Draw draw(41);
    for (double anisotropy : {1.0, 10.0, 1e3, 1e6}) {
        for (int i = 0; i < 50; ++i) {
            const Metric m = draw.metric(draw.uniform(0.01, 100), anisotropy);
            const Metric blend = blended(random_weights(draw, 8), std::vector<Metric>(8, m));
            CHECK(length_difference(blend, m) < 4e-14 * anisotropy);
        }
    }
}

TEST_CASE("a blend of isotropic metrics is the mean of their lengths") {
    Draw draw(42);
    for (int i = 0; i < 100; ++i) {
        const std::vector<double> weights = random_weights(draw, 4);
        std::vector<double> lengths;
        std::vector<Metric> metrics;
        for (int k = 0; k < 4; ++k) {
            lengths.push_back(std::pow(10, draw.uniform(-3, 3)));
            metrics.push_back(Metric::isotropic(lengths.back()));
        }
        const Metric blend = blended(weights, metrics);
        CHECK(is_isotropic(blend));
        const double mean =
            std::inner_product(lengths.begin(), lengths.end(), weights.begin(), 0.0);
        CHECK(blend.xx == Approx(mean).epsilon(1e-14));
    }
}

TEST_CASE("a blend with weights >= 0 is positive definite, and turns with the metrics") {
    Draw draw(43);
    for (double anisotropy : {3.0, 1e3, 1e6}) {
        for (int i = 0; i < 50; ++i) {
            const std::vector<double> weights = random_weights(draw, 8);
            const Eigen::Matrix3d r = draw.rotation();
            std::vector<Metric> metrics;
            std::vector<Metric> turned;
            for (int k = 0; k < 8; ++k) {
                metrics.push_back(draw.metric(std::pow(10, draw.uniform(-3, 3)), anisotropy));
                turned.push_back(rotated(metrics.back(), r));
            }
            const Metric blend = blended(weights, metrics);
            CHECK(is_positive_definite(blend));
            CHECK(difference(blended(weights, turned), rotated(blend, r)) < 1e-13);
        }
    }
}

TEST_CASE("a blend of two metrics in one frame acts on each length alone") {
    Draw draw(44);
    const Eigen::Matrix3d frame = draw.rotation();
    const std::array<double, 3> first{0.1, 2, 0.5};
    const std::array<double, 3> second{0.4, 0.3, 5};
    std::array<double, 3> expected{};
    for (std::size_t i = 0; i < 3; ++i) expected[i] = 0.3 * first[i] + 0.7 * second[i];
    const Metric blend =
        blended({0.3, 0.7}, {metric_from_frame(first, frame), metric_from_frame(second, frame)});
    CHECK(difference(blend, metric_from_frame(expected, frame)) < 1e-13);
}

TEST_CASE("a blend that negative weights spoil is not positive definite") {
    CHECK_FALSE(
        is_positive_definite(blended({-0.5, 1.5}, {{0.1, 10, 1, 0, 0, 0}, Metric::isotropic(1)})));
}

}  // namespace controlspace::blend_test
