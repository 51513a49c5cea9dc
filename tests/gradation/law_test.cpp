// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gradation/law.h"

#include <catch2/catch.hpp>
#include <numbers>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "metric/draw.h"

namespace controlspace::law_test {
namespace {

constexpr double g = 1.25;

}  // namespace

TEST_CASE("closed forms of the laws for isotropic metrics") {
    // Paper-independent arithmetic: h0 + (g-1) d; and (1 + (g-1) d (1/h0 + 1/h1) / 2) h0.
    struct Case {
        GradationLaw law;
        double h0, h1, distance, expected;
    };
    const auto c = GENERATE(Case{GradationLaw::cone, 0.1, 1, 1, 0.35},
                            Case{GradationLaw::mean_length, 0.1, 1, 1, 0.2375},
                            Case{GradationLaw::cone, 0.03, 1.7320508, 0.1, 0.055},
                            Case{GradationLaw::mean_length, 0.03, 1.7320508, 0.1, 0.0427165064});
    Metric m0 = Metric::isotropic(c.h0);
    Metric m1 = Metric::isotropic(c.h1);
    const Vector v = c.distance * Vector(1, 2, -2).normalized();
    const Limited limited = limit_growth(c.law, g, v, m0, m1);
    CHECK(limited.second);
    CHECK_FALSE(limited.first);
    CHECK(m0 == Metric::isotropic(c.h0));
    CHECK(m1.xx == Approx(c.expected).epsilon(5e-9));
    CHECK(is_isotropic(m1));

    SECTION("and the general case agrees with the fast one") {
        Metric general = Metric::isotropic(c.h1);
        Metric small = m0;
        CHECK(limit_anisotropic_growth(c.law, g, v, small, general).second);
        CHECK(difference(general, m1) < 1e-12);
    }
    SECTION("and it does not matter which of the two comes first") {
        Metric a = Metric::isotropic(c.h1);
        Metric b = Metric::isotropic(c.h0);
        CHECK(limit_growth(c.law, g, -v, a, b).first);
        CHECK(a == m1);
    }
}

TEST_CASE("the cone law is M1 <- min(M1, M0 (1 + (g-1) |M0^-1 v|))") {
    Draw draw(1);
    for (int i = 0; i < 200; ++i) {
        const Metric m0 = draw.metric(0.1, 20);
        const Metric old1 = draw.metric(2, 20);
        const Vector v = 0.3 * draw.vector();
        Metric a = m0;
        Metric b = old1;
        limit_growth(GradationLaw::cone, g, v, a, b);
        const double factor = 1 + (g - 1) * metric_length(m0, v);
        CHECK(length_difference(b, intersection(old1, factor * m0)) < 1e-8);
        CHECK(is_within(b, factor * (1 + 1e-8), m0));
        CHECK(is_within(b, 1 + 1e-8, old1));
    }
}

TEST_CASE("after a law was applied, the pair shows no more than the gradation ratio") {
    const auto law = GENERATE(GradationLaw::cone, GradationLaw::mean_length);
    Draw draw(2);
    for (int i = 0; i < 200; ++i) {
        Metric m0 = draw.metric(0.1, 4);
        Metric m1 = draw.metric(1, 4);
        const Vector v = 0.5 * draw.vector();
        limit_growth(law, g, v, m0, m1);
        // Making m1 smaller may leave m0 steep the other way in principle: apply until at rest.
        for (int turn = 0; turn < 50; ++turn) {
            const Limited limited = limit_growth(law, g, v, m0, m1);
            if (!limited.first && !limited.second) break;
        }
        CHECK(growth_between(law, m0, m1, v).gradation() <= g * (1 + 1e-6));
        CHECK(growth_between(law, m1, m0, v).gradation() <= g * (1 + 1e-6));
        CHECK(is_positive_definite(m0));
        CHECK(is_positive_definite(m1));
    }
}

TEST_CASE("laws do not depend on the coordinate system") {
    const auto law = GENERATE(GradationLaw::cone, GradationLaw::mean_length);
    Draw draw(3);
    for (int i = 0; i < 100; ++i) {
        const Metric m0 = draw.metric(0.1, 10);
        const Metric m1 = draw.metric(1, 10);
        const Vector v = 0.3 * draw.vector();
        const Eigen::Matrix3d r = draw.rotation();
        const Growth here = growth_between(law, m0, m1, v);
        const Growth there = growth_between(law, rotated(m0, r), rotated(m1, r), r * v);
        CHECK(there.ratio == Approx(here.ratio).epsilon(1e-9));
        CHECK(there.length == Approx(here.length).epsilon(1e-9));
    }
}

TEST_CASE("growth ratio along eigenvectors, by hand") {
    // diag(1, 2, 4) against diag(2, 2, 2): the second is twice the first along x at most, the first
    // twice the second along z.
    const Metric a{1, 2, 4, 0, 0, 0};
    const Metric b = Metric::isotropic(2);
    const Vector v(1, 0, 0);
    CHECK(growth_between(GradationLaw::mean_length, a, b, v).ratio == Approx(2));
    CHECK(growth_between(GradationLaw::mean_length, b, a, v).ratio == Approx(2));
    CHECK(growth_between(GradationLaw::mean_length, a, b, v).length == Approx(0.75));
    CHECK(growth_between(GradationLaw::cone, a, b, v).length == Approx(1));
    CHECK(growth_between(GradationLaw::cone, b, a, v).length == Approx(0.5));
}

TEST_CASE("growth ratio along eigenvectors that only one of two metrics has") {
    // Every direction is one of the first metric's; the second is four times as long along its own,
    // which no axis is near, and never shorter.
    Draw draw(5);
    const Metric a = Metric::isotropic(1);
    for (int i = 0; i < 20; ++i) {
        const Metric b = rotated({4, 1, 2, 0, 0, 0}, draw.rotation());
        const Vector v(1, 0, 0);
        CHECK(growth_between(GradationLaw::mean_length, a, b, v).ratio == Approx(4));
        CHECK(growth_between(GradationLaw::mean_length, b, a, v).ratio == Approx(1));
    }
}

TEST_CASE("gradation ratios of other programs") {
    // The growth per unit of length is ln(hgrad) in MMG and ln(beta) in refine, g - 1 here.
    CHECK(gradation_ratio_from_mmg(1.3) == Approx(1 + std::log(1.3)));
    CHECK(gradation_ratio_from_mmg(1) == 1);
    CHECK(gradation_ratio_from_refine(std::numbers::e) == Approx(2));
    CHECK_THROWS_AS(gradation_ratio_from_mmg(0.9), InputError);
    CHECK_THROWS_AS(gradation_ratio_from_mmg(-1), InputError);
    CHECK_THROWS_AS(gradation_ratio_from_refine(std::nan("")), InputError);
}

TEST_CASE("growth within the allowed ratio shows a gradation within g, however short the way") {
    for (const double length : {1e-15, 1e-12, 1e-9, 1e-3, 1.0, 1e6}) {
        for (const double noise : {-2e-9, -0.5e-9, 0.0, 0.5e-9, 2e-9}) {
            CAPTURE(length, noise);
            const Growth growth{.ratio = (1 + (g - 1) * length) * (1 + noise), .length = length};
            const bool within = growth.gradation() <= g * (1 + 1e-12) + 1e-15 / length;
            CHECK(within == !growth.exceeds(g));
        }
    }
    CHECK(Growth{.ratio = 3, .length = 2}.gradation() == Approx(2));
}

}  // namespace controlspace::law_test
