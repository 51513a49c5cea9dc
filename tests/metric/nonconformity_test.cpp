// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/nonconformity.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "controlspace/metric/intersection.h"
#include "metric/draw.h"

namespace controlspace::nonconformity_test {

TEST_CASE("check values of nonconformity") {
    const auto iso = [](double h) { return Metric::isotropic(h); };
    CHECK(nonconformity(iso(0.1), iso(1)) == Approx(14.0296115).epsilon(1e-8));
    CHECK(nonconformity(iso(0.03), iso(1.7320508)) == Approx(96.5658984).epsilon(1e-8));
    CHECK(nonconformity(iso(0.2), iso(0.3)) == Approx(0.288675135).epsilon(1e-8));
    CHECK(nonconformity({.1, .4, .2, 0, 0, 0}, {.5, .1, .3, 0, 0, 0}) ==
          Approx(3.91538986).epsilon(1e-8));
}

TEST_CASE("nonconformity of isotropic metrics in closed form") {
    for (double k : {1.0, 1 + 1e-9, 1.5, 10.0, 1e6}) {
        const double expected = std::sqrt(3) * (k - 1) * (k - 1) / k;
        CHECK(nonconformity(Metric::isotropic(0.3), Metric::isotropic(0.3 * k)) ==
              Approx(expected).epsilon(1e-6));
        const double squared = std::sqrt(3) * (k * k - 1) * (k * k - 1) / (k * k);
        CHECK(riemannian_nonconformity(Metric::isotropic(0.3), Metric::isotropic(0.3 * k)) ==
              Approx(squared).epsilon(1e-6));
    }
}

TEST_CASE("nonconformity is the Frobenius norm of its definition") {
    Draw draw(31);
    const Eigen::Matrix3d two = 2 * Eigen::Matrix3d::Identity();
    for (int i = 0; i < 300; ++i) {
        const Metric a = draw.metric(1, 20);
        const Metric b = draw.metric(2, 20);
        const Eigen::Matrix3d ma = a.matrix();
        const Eigen::Matrix3d mb = b.matrix();
        CHECK(nonconformity(a, b) ==
              Approx((ma.inverse() * mb + mb.inverse() * ma - two).norm()).epsilon(1e-11));
        const Eigen::Matrix3d ra = (ma * ma).inverse();
        const Eigen::Matrix3d rb = (mb * mb).inverse();
        CHECK(riemannian_nonconformity(a, b) ==
              Approx((ra.inverse() * rb + rb.inverse() * ra - two).norm()).epsilon(1e-9));
    }
}

TEST_CASE("the largest ratio is that of lengths along some direction, and above all others") {
    CHECK(largest_ratio(Metric::isotropic(0.3), Metric::isotropic(0.6)) == 2);
    CHECK(largest_ratio({.1, .4, .2, 0, 0, 0}, {.5, .1, .3, 0, 0, 0}) == Approx(5));
    Draw draw(33);
    for (const double anisotropy : {1.0, 30.0, 1e6}) {
        for (int i = 0; i < 50; ++i) {
            const Metric a = draw.metric(1, anisotropy);
            const Metric b = draw.metric(2, anisotropy);
            const double most = largest_ratio(a, b);
            // Each tensor fixes its lengths to a relative 1e-16 times its anisotropy.
            const double tolerance = std::max(1e-10, 1e-16 * anisotropy * anisotropy);
            CHECK(most >= 1 - tolerance);
            CHECK(most == Approx(largest_ratio(b, a)).epsilon(tolerance));
            CHECK(most == Approx(std::max(growth(a, b), growth(b, a))).epsilon(tolerance));
            for (int k = 0; k < 50; ++k) {
                const Vector v = draw.vector();
                const double ratio = metric_length(a, v) / metric_length(b, v);
                CHECK(std::max(ratio, 1 / ratio) <= most * (1 + tolerance));
            }
        }
    }
}

TEST_CASE("nonconformity is zero for equals, symmetric, and free of frame and unit") {
    Draw draw(32);
    for (double anisotropy : {1.0, 3.0, 1e3, 1e6}) {
        for (int i = 0; i < 100; ++i) {
            const Metric a = draw.metric(1, anisotropy);
            const Metric b = draw.metric(0.1, anisotropy);
            const double tolerance = 1e-13 * anisotropy;
            for (auto delta : {nonconformity, riemannian_nonconformity}) {
                const bool squared = delta == riemannian_nonconformity;
                CHECK(delta(a, a) <= tolerance * (squared ? anisotropy : 1));
                CHECK(delta(a, b) == Approx(delta(b, a)).epsilon(tolerance));
                CHECK(delta(0x1p20 * a, 0x1p20 * b) == delta(a, b));
                const Eigen::Matrix3d r = draw.rotation();
                CHECK(delta(rotated(a, r), rotated(b, r)) ==
                      Approx(delta(a, b)).epsilon(10 * tolerance));
            }
        }
    }
}

TEST_CASE("axis-aligned nonconformity is that of slightly turned metrics") {
    const Metric a{0.2, 3, 0.7, 0, 0, 0};
    const Metric b{0.5, 1, 0.9, 0, 0, 0};
    Metric turned = a;
    turned.xz = 1e-14;
    CHECK(nonconformity(a, b) == Approx(nonconformity(turned, b)).epsilon(1e-12));
    CHECK(riemannian_nonconformity(a, b) ==
          Approx(riemannian_nonconformity(turned, b)).epsilon(1e-11));
}

TEST_CASE("directional nonconformity bounds each length by itself") {
    Draw draw(34);
    for (int i = 0; i < 100; ++i) {
        const Metric a = draw.metric(1, 20);
        const Metric b = draw.metric(1, 20);
        const double delta = directional_nonconformity(a, b);
        CHECK(delta >= nonconformity(a, b));
        CHECK(delta == Approx(directional_nonconformity(b, a)).epsilon(1e-9));
        const double k = std::max(growth(a, b), growth(b, a));
        CHECK(k <= largest_factor_along(delta) * (1 + 1e-9));
        // The longest factor from singular values, which does not depend on a polynomial.
        CHECK(delta == Approx(std::max(nonconformity(a, b), nonconformity_along(k))).epsilon(1e-9));
        const Metric near = Metric::from_matrix(a.matrix() + 0.01 * draw.metric(0.01, 2).matrix());
        const double k_near = std::max(growth(a, near), growth(near, a));
        CHECK(directional_nonconformity(a, near) ==
              Approx(std::max(nonconformity(a, near), nonconformity_along(k_near))).epsilon(1e-7));
        const Metric c = Metric::isotropic(a.xx);
        const Metric d = Metric::isotropic(b.xx);
        CHECK(directional_nonconformity(c, d) == nonconformity(c, d));
    }
    // Along one direction alone it is δ; of a thin metric that is turned a little, more.
    const Metric thin{1, 0.01, 1, 0, 0, 0};
    CHECK(directional_nonconformity(thin, {1, 0.013, 1, 0, 0, 0}) ==
          Approx(nonconformity_along(1.3)));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.02, Vector::UnitZ()).toRotationMatrix();
    const Metric turned = Metric::from_matrix(turn * thin.matrix() * turn.transpose());
    CHECK(directional_nonconformity(thin, turned) ==
          Approx(nonconformity_along(growth(thin, turned))));
    CHECK(nonconformity(thin, turned) < 0.5 * directional_nonconformity(thin, turned));
}

TEST_CASE("the largest factor within a nonconformity has just that") {
    for (const double delta : {1e-9, 1e-3, 0.1, 2.0, 1e3}) {
        const Metric longer = Metric::isotropic(0.3 * largest_factor_within(delta));
        CHECK(nonconformity(Metric::isotropic(0.3), longer) == Approx(delta).epsilon(1e-6));
        CHECK(nonconformity_along(largest_factor_along(delta)) == Approx(delta).epsilon(1e-6));
    }
}

}  // namespace controlspace::nonconformity_test
