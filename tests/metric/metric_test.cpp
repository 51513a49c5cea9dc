// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/metric.h"

#include <catch2/catch.hpp>
#include <limits>

#include "metric/draw.h"

namespace controlspace::metric_test {

TEST_CASE("a metric's frame gives it back") {
    Draw draw(1);
    for (double anisotropy : {1.0, 1.0 + 1e-12, 2.0, 1e3, 1e6}) {
        for (int i = 0; i < 200; ++i) {
            const Metric m = draw.metric(draw.uniform(0.1, 10), anisotropy);
            const EigenFrame frame = eigen_frame(m);
            CHECK(frame.lengths[0] > 0);
            CHECK(frame.lengths[0] <= frame.lengths[1]);
            CHECK(frame.lengths[1] <= frame.lengths[2]);
            CHECK((frame.directions.transpose() * frame.directions)
                      .isApprox(Eigen::Matrix3d::Identity(), 1e-14));
            CHECK(difference(metric_from_frame(frame.lengths, frame.directions), m) < 3e-15);
        }
    }
}

TEST_CASE("eigen_frame agrees with Eigen's solver") {
    Draw draw(2);
    for (double anisotropy : {1.5, 10.0, 1e4}) {
        for (int i = 0; i < 200; ++i) {
            const Metric m = draw.metric(1, anisotropy);
            const EigenFrame frame = eigen_frame(m);
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.matrix());
            for (int k = 0; k < 3; ++k) {
                CHECK(frame.lengths[static_cast<std::size_t>(k)] ==
                      Approx(solver.eigenvalues()[k]).epsilon(1e-15 * anisotropy));
            }
        }
    }
}

TEST_CASE("eigen_frame of closed forms") {
    // (2 1 0; 1 2 0; 0 0 5): 1 along (1,-1,0), 3 along (1,1,0), 5 along z.
    const EigenFrame frame = eigen_frame({2, 2, 5, 1, 0, 0});
    CHECK(frame.lengths[0] == Approx(1).epsilon(1e-15));
    CHECK(frame.lengths[1] == Approx(3).epsilon(1e-15));
    CHECK(frame.lengths[2] == 5);
    CHECK(std::abs(frame.directions.col(0).dot(Vector(1, -1, 0))) == Approx(std::sqrt(2)));
    CHECK(std::abs(frame.directions.col(1).dot(Vector(1, 1, 0))) == Approx(std::sqrt(2)));

    // a + b (1 1 1)(1 1 1)^T: a twice, and a + 3b.
    const EigenFrame twice = eigen_frame({3, 3, 3, 1, 1, 1});
    CHECK(twice.lengths[0] == Approx(2).epsilon(1e-15));
    CHECK(twice.lengths[1] == Approx(2).epsilon(1e-15));
    CHECK(twice.lengths[2] == Approx(5).epsilon(1e-15));

    // Diagonal tensors come sorted and exact, singular and indefinite ones as they are.
    CHECK(eigen_frame({3, 1, 2, 0, 0, 0}).lengths == std::array<double, 3>{1, 2, 3});
    CHECK(eigen_frame({0, 0, 0, 0, 0, 0}).lengths == std::array<double, 3>{0, 0, 0});
    const EigenFrame indefinite = eigen_frame({0, 0, 0, 1, 0, 0});
    CHECK(indefinite.lengths[0] == Approx(-1).epsilon(1e-15));
    CHECK(indefinite.lengths[2] == Approx(1).epsilon(1e-15));
}

TEST_CASE("metric lengths are displacements over lengths") {
    Draw draw(3);
    for (int i = 0; i < 200; ++i) {
        const auto lengths = draw.lengths(1, 100);
        const Eigen::Matrix3d frame = draw.rotation();
        const Metric m = metric_from_frame(lengths, frame);
        const Vector v = draw.vector();
        const Vector in_frame = frame.transpose() * v;
        const Vector expected(in_frame[0] / lengths[0], in_frame[1] / lengths[1],
                              in_frame[2] / lengths[2]);
        CHECK(metric_length(m, v) == Approx(expected.norm()).epsilon(1e-12));
        CHECK((m.matrix() * to_metric_space(m, v)).isApprox(v, 1e-12));
        const Vector edges(0.3, 0.7, 1.9);
        for (Axis a = 0; a < 3; ++a) {
            CHECK(metric_edge_lengths(m, edges)[static_cast<std::size_t>(a)] ==
                  Approx(metric_length(m, edges[a] * Vector::Unit(a))).epsilon(1e-12));
        }
    }
    CHECK(metric_length(Metric::isotropic(0.25), {3, 4, 0}) == 20);
    CHECK(metric_length({1, 2, 4, 0, 0, 0}, {1, 2, 4}) == Approx(std::sqrt(3)));
    CHECK(metric_edge_lengths({1, 2, 4, 0, 0, 0}, {2, 2, 2}) == std::array<double, 3>{2, 1, 0.5});
}

TEST_CASE("axis-aligned metrics measure as slightly turned ones do") {
    const Metric aligned{0.2, 3, 0.7, 0, 0, 0};
    Metric turned = aligned;
    turned.xy = turned.yz = 1e-14;
    const Vector v(0.3, -0.4, 2);
    CHECK(metric_length(aligned, v) == Approx(metric_length(turned, v)).epsilon(1e-12));
    for (std::size_t a = 0; a < 3; ++a) {
        CHECK(metric_edge_lengths(aligned, v.cwiseAbs())[a] ==
              Approx(metric_edge_lengths(turned, v.cwiseAbs())[a]).epsilon(1e-12));
    }
}

TEST_CASE("equal lengths are isotropic whatever the frame") {
    Draw draw(4);
    CHECK(metric_from_frame({0.03, 0.03, 0.03}, draw.rotation()) == Metric::isotropic(0.03));
}

TEST_CASE("positive definite or not") {
    Draw draw(5);
    for (double size : {1e-6, 1.0, 1e6}) {
        for (double anisotropy : {1.0, 1e3, 1e6}) {
            CHECK(is_positive_definite(draw.metric(size, anisotropy)));
            const auto [h0, h1, h2] = draw.lengths(size, anisotropy);
            CHECK_FALSE(is_positive_definite(metric_from_frame({-h0, h1, h2}, draw.rotation())));
            CHECK_FALSE(is_positive_definite(metric_from_frame({-h0, -h1, h2}, draw.rotation())));
            CHECK_FALSE(is_positive_definite(metric_from_frame({-h0, -h1, -h2}, draw.rotation())));
        }
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    CHECK_FALSE(is_positive_definite({0, 0, 0, 0, 0, 0}));
    CHECK_FALSE(is_positive_definite({1, 1, 0, 0, 0, 0}));
    CHECK_FALSE(is_positive_definite({1, 1, 1, 1, 0, 0}));
    CHECK_FALSE(is_positive_definite({nan, 1, 1, 0, 0, 0}));
    CHECK_FALSE(is_positive_definite({1, 1, 1, 0, nan, 0}));
    CHECK_FALSE(is_positive_definite({1, 1, infinity, 0, 0, 0}));
    CHECK_FALSE(is_positive_definite({infinity, infinity, infinity, 0, 0, 0}));
}

}  // namespace controlspace::metric_test
