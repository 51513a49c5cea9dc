// SPDX-License-Identifier: Apache-2.0
// How metrics behave when the unit of length or the names of the axes change.
#include <catch2/catch.hpp>
#include <vector>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "metric/draw.h"

namespace controlspace::laws_test {
namespace {

struct Pair {
    Metric a, b;
    Vector v;
};

std::vector<Pair> pairs() {
    Draw draw(31);
    std::vector<Pair> all;
    for (const double anisotropy : {1.0, 2.0, 30.0, 1e3}) {
        for (int i = 0; i < 20; ++i) {
            const auto [h0, h1, h2] = draw.lengths(0.7, anisotropy);
            all.push_back(
                {draw.metric(1, anisotropy), draw.metric(0.7, anisotropy), draw.vector()});
            all.push_back({draw.metric(1, anisotropy), {h0, h1, h2, 0, 0, 0}, draw.vector()});
            all.push_back({draw.metric(1, anisotropy), Metric::isotropic(h0), draw.vector()});
            all.push_back({{h2, h0, h1, 0, 0, 0}, {h0, h1, h2, 0, 0, 0}, draw.vector()});
        }
    }
    return all;
}

Metric blended(const Metric& a, const Metric& b) {
    const double weights[] = {0.3, 0.7};
    return blend_lengths(weights, [&](std::size_t i) { return i == 0 ? a : b; });
}

}  // namespace

TEST_CASE("In a unit that is 8 times as short, all lengths are 8 times as long, to the bit") {
    constexpr double k = 8;
    for (const auto& [a, b, v] : pairs()) {
        REQUIRE(intersection(k * a, k * b) == k * intersection(a, b));
        REQUIRE(nonconformity(k * a, k * b) == nonconformity(a, b));
        REQUIRE(riemannian_nonconformity(k * a, k * b) == riemannian_nonconformity(a, b));
        REQUIRE(growth(k * a, k * b) == growth(a, b));
        REQUIRE(metric_length(k * a, k * v) == metric_length(a, v));
        REQUIRE(blended(k * a, k * b) == k * blended(a, b));
    }
}

TEST_CASE("In any other unit, up to rounding") {
    const double k = GENERATE(0.3048, 1e-9, 12345.678);
    for (const auto& [a, b, v] : pairs()) {
        constexpr double rounding = 1e-11;  // 1e-14 times the anisotropy
        REQUIRE(difference(intersection(k * a, k * b), k * intersection(a, b)) < rounding);
        REQUIRE(nonconformity(k * a, k * b) == Approx(nonconformity(a, b)).epsilon(1e-9));
        REQUIRE(growth(k * a, k * b) == Approx(growth(a, b)).epsilon(1e-11));
        REQUIRE(metric_length(k * a, k * v) == Approx(metric_length(a, v)).epsilon(1e-11));
        REQUIRE(difference(blended(k * a, k * b), k * blended(a, b)) < rounding);
    }
}

TEST_CASE("Renaming the axes renames those of all results") {
    Eigen::Matrix3d turn;  // x to y, y to z, z to x
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    Eigen::Matrix3d swap;
    swap << 0, 1, 0, 1, 0, 0, 0, 0, 1;
    for (const Eigen::Matrix3d& p : {turn, Eigen::Matrix3d(turn * turn), swap}) {
        for (const auto& [a, b, v] : pairs()) {
            const Metric pa = rotated(a, p);
            const Metric pb = rotated(b, p);
            const Vector pv = p * v;
            REQUIRE(difference(intersection(pa, pb), rotated(intersection(a, b), p)) < 1e-11);
            REQUIRE(nonconformity(pa, pb) == Approx(nonconformity(a, b)).epsilon(1e-9));
            REQUIRE(growth(pa, pb) == Approx(growth(a, b)).epsilon(1e-11));
            REQUIRE(metric_length(pa, pv) == Approx(metric_length(a, v)).epsilon(1e-11));
            REQUIRE(difference(blended(pa, pb), rotated(blended(a, b), p)) < 1e-11);
        }
    }
}

}  // namespace controlspace::laws_test
