// SPDX-License-Identifier: Apache-2.0
// The algebra at the edges of what doubles can say, judged in long double.
#include <Eigen/Dense>
#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/blend.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/order_free_intersection.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/riemannian.h"
#include "controlspace/space/control_space_builder.h"
#include "metric/draw.h"

namespace controlspace::edges_test {
namespace {

using Long = long double;
using LongMatrix = Eigen::Matrix<Long, 3, 3>;
using LongSolver = Eigen::SelfAdjointEigenSolver<LongMatrix>;

LongMatrix long_matrix(const Metric& m) { return m.matrix().cast<Long>(); }

bool is_definite(const Metric& m) {
    return m.matrix().allFinite() && LongSolver(long_matrix(m)).eigenvalues()[0] > 0;
}

Long condition_of(const Metric& m) {
    const auto lengths = LongSolver(long_matrix(m)).eigenvalues();
    return lengths[2] / lengths[0];
}

// By how much `a` is longer than `b` in some direction: the largest singular value of b^-1 a.
Long longest(const Metric& a, const Metric& b) {
    const LongMatrix c = long_matrix(b).llt().solve(long_matrix(a));
    return std::sqrt(LongSolver(c.transpose() * c).eigenvalues()[2]);
}

// What the six numbers leave open: see `condition` in metric/decompose.h.
Long doubt(const Metric& a, const Metric& b) {
    return 2e-14L * std::max(condition_of(a), condition_of(b));
}

// By how much `m` exceeds `limit`, in units of the doubt: at most 1 for what is within.
double excess(const Metric& m, const Metric& limit) {
    return static_cast<double>((longest(m, limit) - 1) / doubt(m, limit));
}

// Sources beyond 1e-50 to 1e50 are refused; beyond 1e-90 products of squares underflow.
constexpr std::array sizes{1e-49, 1e-20, 1.0, 1e20, 1e49};
constexpr std::array conditions{1.0, 1 + 4e-16, 1 + 1e-12, 1e3, 1e6, 1e9, 1e12};

// Turned, along the axes in all their orders, turned by hairs, and with two lengths that are equal,
// nearly or to the bit.
std::vector<Metric> metrics(double size, double condition) {
    Draw draw(61);
    const double low = size / std::sqrt(condition), high = size * std::sqrt(condition);
    const double beside = low * (1 + 4e-16);
    const Eigen::Matrix3d hair =
        Eigen::AngleAxisd(1e-9, Vector(1, 2, 3).normalized()).toRotationMatrix();
    std::vector<Metric> all{{low, size, high, 0, 0, 0}, {high, low, size, 0, 0, 0},
                            {size, high, low, 0, 0, 0}, {low, high, size, 0, 0, 0},
                            {low, low, high, 0, 0, 0},  {high, high, low, 0, 0, 0}};
    for (const std::array<double, 3>& lengths :
         {std::array{low, size, high}, std::array{low, beside, high},
          std::array{low, high, high}}) {
        all.push_back(metric_from_frame(lengths, draw.rotation()));
        all.push_back(metric_from_frame(lengths, draw.rotation()));
        all.push_back(metric_from_frame(lengths, hair));
    }
    return all;
}

template <class Check>
void for_all(const Check& check) {
    for (const double size : sizes) {
        for (const double condition : conditions) {
            CAPTURE(size, condition);
            check(metrics(size, condition));
        }
    }
}

}  // namespace

TEST_CASE("edges: frames give metrics back, with orthonormal directions") {
    for_all([](const std::vector<Metric>& all) {
        for (const Metric& m : all) {
            CAPTURE(to_string(m));
            const EigenFrame frame = eigen_frame(m);
            REQUIRE(frame.lengths[0] > 0);
            REQUIRE(frame.directions.isUnitary(1e-14));
            REQUIRE(difference(metric_from_frame(frame.lengths, frame.directions), m) < 1e-14);
            const auto exact = LongSolver(long_matrix(m)).eigenvalues();
            const auto shortest = static_cast<double>(exact[0] / frame.lengths[0]);
            REQUIRE(std::abs(shortest - 1) <= 2e-15 * static_cast<double>(condition_of(m)));
        }
    });
}

TEST_CASE("edges: of two metrics, intersection, growth and blend") {
    for_all([](const std::vector<Metric>& all) {
        for (const Metric& a : all) {
            for (const Metric& b : all) {
                CAPTURE(to_string(a), to_string(b));
                const Metric m = intersection(a, b);
                REQUIRE(is_definite(m));
                REQUIRE(excess(m, a) <= 1);
                REQUIRE(excess(m, b) <= 1);
                const auto exact = static_cast<double>(longest(a, b));
                const auto digits = static_cast<double>(doubt(a, b));
                REQUIRE(growth(a, b) == Approx(exact).epsilon(digits));
                REQUIRE(is_within(a, exact * (1 + 2 * digits), b));
                const double weights[] = {0.25, 0.75};
                const Metric mean =
                    blend_lengths(weights, [&](std::size_t i) { return i == 0 ? a : b; });
                REQUIRE(is_definite(mean));
                REQUIRE(static_cast<double>(longest(mean, b)) <=
                        (0.25 * exact + 0.75) * (1 + digits));
            }
        }
    });
}

TEST_CASE("edges: of many metrics, within all of them, or the error says why") {
    for_all([](const std::vector<Metric>& all) {
        const auto whole = [&]() -> std::optional<Metric> {
            try {
                return order_free_intersection(all).metric();
            } catch (const InputError& error) {
                const std::string text = error.what();
                const bool says_why = text.find("anisotropy above") != std::string::npos ||
                                      text.find("another unit of length") != std::string::npos;
                CHECK(says_why);
                return std::nullopt;
            }
        }();
        // What it promises to accept.
        const auto condition = static_cast<double>(condition_of(all.front()));
        const double size = all[0].yy;
        if (condition < 1e6 && size > 1e-70 && size < 1e70) REQUIRE(whole);
        if (!whole) return;
        REQUIRE(is_definite(*whole));
        for (const Metric& m : all) {
            REQUIRE(excess(*whole, m) <= 1);
        }
    });
}

TEST_CASE("edges: sources of lengths beyond 1e-50 to 1e50 are refused, and the error says why") {
    const Box domain{Point(0, 0, 0), Point(1, 1, 1)};
    constexpr double denormal = std::numeric_limits<double>::denorm_min();
    for (const double size : {denormal, 1e-310, 1e-300, 1e-200, 1e-60, 1e60, 1e200, 1e300}) {
        const Metric turned = Draw(3).metric(size, size < 1e-300 ? 1 : 4);
        for (const Metric& m : {Metric::isotropic(size), Metric{size, 2 * size, size, 0, 0, 0},
                                Metric{1, 1, size, 0, 0, 0}, turned}) {
            CAPTURE(to_string(m));
            CHECK_FALSE(is_source_metric(m));
            CHECK_FALSE(is_valid({Point(0.5, 0.5, 0.5), m}, domain));
            CHECK_THROWS_AS(require_valid({Point(0.5, 0.5, 0.5), m}, 0, domain), InputError);
        }
    }
    for (const double size : {1e-49, 1.0, 1e49}) {
        CHECK(is_valid({Point(0.5, 0.5, 0.5), Draw(3).metric(size, 4)}, domain));
    }
}

TEST_CASE("edges: Riemannian metrics are read as long as they say, or not at all") {
    for (const double size : {1e-160, 1e-100, 1e-40, 1.0, 1e40, 1e100, 1e160}) {
        for (const double condition : {1.0, 1 + 1e-12, 1e3, 1e6}) {
            for (const Metric& riemannian : metrics(size, condition * condition)) {
                CAPTURE(to_string(riemannian));
                const std::optional<Metric> m = from_riemannian(riemannian);
                const bool is_in_range = size > 1e-90 && size < 1e90;
                if (is_in_range) REQUIRE(m);
                if (!m) continue;
                REQUIRE(is_definite(*m));
                REQUIRE(is_source_metric(*m));
                // M 𝓜 M = I, up to the digits of 𝓜.
                const LongMatrix unit = long_matrix(*m) * long_matrix(riemannian) * long_matrix(*m);
                const auto off =
                    static_cast<double>((unit - LongMatrix::Identity()).cwiseAbs().maxCoeff());
                REQUIRE(off <= 1e-13 * static_cast<double>(condition_of(riemannian)));
            }
        }
    }
}

}  // namespace controlspace::edges_test
