// SPDX-License-Identifier: Apache-2.0
#include "metric/decompose.h"

#include <catch2/catch.hpp>

#include "metric/draw.h"

namespace controlspace::decompose_test {
namespace {

Eigen::Matrix3d product(const Svd& d) {
    return d.u * Vector(d.s[0], d.s[1], d.s[2]).asDiagonal() * d.v.transpose();
}

void check_svd(const Eigen::Matrix3d& b) {
    const Svd d = svd(b);
    const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
    CHECK(d.s[0] >= d.s[1]);
    CHECK(d.s[1] >= d.s[2]);
    CHECK((d.u.transpose() * d.u).isApprox(identity, 1e-14));
    CHECK((d.v.transpose() * d.v).isApprox(identity, 1e-14));
    CHECK((product(d) - b).norm() <= 3e-15 * b.norm());
    const auto [u, s] = left_svd(b);
    CHECK(u == d.u);
    CHECK(s == d.s);
    const Vector expected = Eigen::JacobiSVD<Eigen::Matrix3d>(b).singularValues();
    for (int i = 0; i < 3; ++i) {
        CHECK(d.s[static_cast<std::size_t>(i)] ==
              Approx(expected[i]).epsilon(1e-14).margin(1e-14 * d.s[0]));
    }
}

}  // namespace

TEST_CASE("singular values agree with Eigen's JacobiSVD") {
    Draw draw(11);
    for (int i = 0; i < 300; ++i) {
        Eigen::Matrix3d b;
        for (int c = 0; c < 3; ++c) b.col(c) = draw.vector();
        check_svd(b);
        check_svd(draw.rotation());
        check_svd(1e-6 * draw.rotation() * Vector(1e-6, 1, 1).asDiagonal() * draw.rotation());
        check_svd(1e6 * draw.rotation() * Vector(1, 1 + 1e-9, 1e6).asDiagonal() * draw.rotation());
    }
    check_svd(Eigen::Matrix3d::Identity());
}

TEST_CASE("small singular values keep their digits under scaled columns") {
    // A D with A well conditioned: s of A D scales as D does, to relative accuracy.
    const Eigen::Matrix3d a = (Eigen::Matrix3d() << 1, 1, 0, -1, 1, 0, 0, 0, 1).finished();
    const Svd d = svd(a * Vector(1e-9, 1, 1e9).asDiagonal());
    CHECK(d.s[0] == Approx(1e9).epsilon(1e-15));
    CHECK(d.s[1] == Approx(std::sqrt(2)).epsilon(1e-15));
    CHECK(d.s[2] == Approx(std::sqrt(2) * 1e-9).epsilon(1e-15));
}

TEST_CASE("the left polar factor squares to B B^T") {
    Draw draw(12);
    for (int i = 0; i < 200; ++i) {
        const Metric m = draw.metric(1, 100);
        CHECK(difference(left_polar_factor(m.matrix() * draw.rotation()), m) < 1e-13);
    }
}

TEST_CASE("Cholesky solves") {
    Draw draw(13);
    for (double anisotropy : {1.0, 1e3, 1e6}) {
        for (int i = 0; i < 200; ++i) {
            const Metric m = draw.metric(1, anisotropy);
            const Vector x = draw.vector();
            CHECK((Cholesky(m).solve(Vector(m.matrix() * x)) - x).norm() <
                  1e-14 * anisotropy * x.norm());
            const double estimate = condition(m, Cholesky(m));
            CHECK(estimate <= anisotropy * (1 + 1e-9));
            CHECK(estimate >= anisotropy / 9 * (1 - 1e-9));
        }
    }
    CHECK(condition(Metric::isotropic(0.3), Cholesky(Metric::isotropic(0.3))) ==
          Approx(1).epsilon(1e-15));
}

}  // namespace controlspace::decompose_test
