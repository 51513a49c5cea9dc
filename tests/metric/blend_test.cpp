#include "controlspace/metric/blend.h"

#include <catch2/catch.hpp>
#include <vector>

#include "metric/draw.h"

using namespace controlspace;

namespace {

constexpr Blend schemes[] = {Blend::lengths, Blend::riemannian, Blend::inverse,
                             Blend::log_euclidean};

std::vector<double> random_weights(Draw& draw, std::size_t n) {
    std::vector<double> weights(n);
    double sum = 0;
    for (double& w : weights) sum += w = draw.uniform(0, 1);
    for (double& w : weights) w /= sum;
    return weights;
}

// Weighted power mean of lengths: what each scheme does to isotropic metrics.
double mean(Blend scheme, const std::vector<double>& w, const std::vector<double>& h) {
    double sum = 0;
    for (std::size_t i = 0; i < h.size(); ++i) {
        switch (scheme) {
            case Blend::lengths:
                sum += w[i] * h[i];
                break;
            case Blend::riemannian:
                sum += w[i] / (h[i] * h[i]);
                break;
            case Blend::inverse:
                sum += w[i] * h[i] * h[i];
                break;
            case Blend::log_euclidean:
                sum += w[i] * std::log(h[i]);
                break;
        }
    }
    switch (scheme) {
        case Blend::lengths:
            break;
        case Blend::riemannian:
            return 1 / std::sqrt(sum);
        case Blend::inverse:
            return std::sqrt(sum);
        case Blend::log_euclidean:
            return std::exp(sum);
    }
    return sum;
}

}  // namespace

TEST_CASE("every blend reproduces a constant") {
    Draw draw(41);
    const Blend scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    for (double anisotropy : {1.0, 10.0, 1e3, 1e6}) {
        for (int i = 0; i < 50; ++i) {
            const Metric m = draw.metric(draw.uniform(0.01, 100), anisotropy);
            const std::vector<Metric> metrics(8, m);
            const Metric blended = blend(random_weights(draw, 8), metrics, scheme);
            // M^-2 and M^2 square the anisotropy: half of the digits are left.
            const bool squares = scheme == Blend::riemannian || scheme == Blend::inverse;
            const double digits = squares ? 1e-14 * anisotropy * anisotropy : 1e-14 * anisotropy;
            CHECK(length_difference(blended, m) < 4 * digits);
        }
    }
}

TEST_CASE("every blend of isotropic metrics is a mean of their lengths") {
    Draw draw(42);
    const Blend scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    for (int i = 0; i < 100; ++i) {
        const std::vector<double> weights = random_weights(draw, 4);
        std::vector<double> lengths;
        std::vector<Metric> metrics;
        for (int k = 0; k < 4; ++k) {
            lengths.push_back(std::pow(10, draw.uniform(-3, 3)));
            metrics.push_back(Metric::isotropic(lengths.back()));
        }
        const Metric blended = blend(weights, metrics, scheme);
        CHECK(is_isotropic(blended));
        CHECK(blended.xx == Approx(mean(scheme, weights, lengths)).epsilon(1e-14));
    }
}

TEST_CASE("every blend with weights >= 0 is positive definite, turns with the metrics") {
    Draw draw(43);
    const Blend scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
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
            const Metric blended = blend(weights, metrics, scheme);
            CHECK(is_positive_definite(blended));
            if (anisotropy > 1e3) continue;
            CHECK(difference(blend(weights, turned, scheme), rotated(blended, r)) < 1e-7);
        }
    }
}

TEST_CASE("blends of two metrics in one frame act on each length alone") {
    Draw draw(44);
    const Blend scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const std::vector<double> weights{0.3, 0.7};
    const Eigen::Matrix3d frame = draw.rotation();
    const std::array<double, 3> first{0.1, 2, 0.5};
    const std::array<double, 3> second{0.4, 0.3, 5};
    std::array<double, 3> expected{};
    for (std::size_t i = 0; i < 3; ++i) expected[i] = mean(scheme, weights, {first[i], second[i]});
    const std::vector<Metric> metrics{metric_from_frame(first, frame),
                                      metric_from_frame(second, frame)};
    CHECK(difference(blend(weights, metrics, scheme), metric_from_frame(expected, frame)) < 1e-13);
}

TEST_CASE("a blend that negative weights spoil is not positive definite") {
    const std::vector<double> weights{-0.5, 1.5};
    const std::vector<Metric> metrics{{0.1, 10, 1, 0, 0, 0}, Metric::isotropic(1)};
    const Blend scheme = GENERATE(Blend::lengths, Blend::riemannian, Blend::inverse);
    CHECK_FALSE(is_positive_definite(blend(weights, metrics, scheme)));
    CHECK(is_positive_definite(blend(weights, metrics, Blend::log_euclidean)));
}
