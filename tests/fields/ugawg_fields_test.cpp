// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/ugawg_fields.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "fields/values.h"
#include "metric/draw.h"

namespace controlspace::ugawg_fields_test {
namespace {

// The benchmark's own form: the Riemannian metric R diag(h_r^-2, h_t^-2, h_z^-2) R^T with R by
// sine and cosine of the angle, and M its inverse square root.
Metric published_polar(const Point& p, double h_r, double h_t) {
    const double t = std::atan2(p.y(), p.x());
    Eigen::Matrix3d turn;
    turn << std::cos(t), -std::sin(t), 0, std::sin(t), std::cos(t), 0, 0, 0, 1;
    const Vector squares(1 / (h_r * h_r), 1 / (h_t * h_t), 100);
    const Eigen::Matrix3d riemannian = turn * squares.asDiagonal() * turn.transpose();
    return Metric::from_matrix(
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(riemannian).operatorInverseSqrt());
}

double h_across(double x) { return 0.001 + 2 * (0.1 - 0.001) * std::abs(x - 0.5); }

Point place(Draw& draw) { return {draw.uniform(0, 1), draw.uniform(0, 1), draw.uniform(0, 1)}; }

}  // namespace

TEST_CASE("UGAWG linear: a layer at z = 0.5, 100:1") {
    const auto field = ugawg_linear();
    const Metric layer = value_at(*field.field, {0.3, 0.9, 0.5});
    CHECK(layer == Metric{0.1, 0.1, 0.001, 0, 0, 0});
    for (const double z : {0.0, 1.0}) {
        CHECK(difference(value_at(*field.field, {0, 1, z}), Metric::isotropic(0.1)) < 1e-15);
    }
    Draw draw(1);
    for (int i = 0; i < 100; ++i) {
        const Point p = place(draw);
        const Metric m = value_at(*field.field, p);
        CHECK(m.zz == Approx(h_across(p.z())).epsilon(1e-14));
        const Metric mirrored = value_at(*field.field, {p.y(), p.x(), 1 - p.z()});
        CHECK(difference(m, mirrored) < 1e-12);
    }
}

TEST_CASE("UGAWG polar fields are the published Riemannian metrics") {
    Draw draw(2);
    for (int i = 0; i < 300; ++i) {
        const Point p = place(draw);
        const double r = std::sqrt(p.x() * p.x() + p.y() * p.y());
        const double d = std::min(10 * std::abs(r - 0.5), 1.0);
        const double h_t = 0.1 * d + 0.025 * (1 - d);
        CHECK(difference(value_at(*ugawg_polar_1().field, p),
                         published_polar(p, h_across(r), 0.1)) < 1e-11);
        CHECK(difference(value_at(*ugawg_polar_2().field, p),
                         published_polar(p, h_across(r), h_t)) < 1e-11);
    }
}

TEST_CASE("UGAWG polar fields turn around the z axis, and do not change along it") {
    Draw draw(3);
    const auto quarter = [&](const AnalyticField& field) {
        for (int i = 0; i < 100; ++i) {
            const double r = draw.uniform(0, 1);
            const double t = draw.uniform(0, std::numbers::pi / 2);
            const double z = draw.uniform(0, 1);
            const Eigen::Matrix3d turn = Eigen::AngleAxisd(t, Vector::UnitZ()).toRotationMatrix();
            const Metric start = value_at(*field.field, {r, 0, 0});
            const Metric m = value_at(*field.field, turn * Point(r, 0, z));
            CHECK(difference(m, rotated(start, turn)) < 1e-11);
        }
    };
    quarter(ugawg_polar_1());
    quarter(ugawg_polar_2());
}

TEST_CASE("UGAWG fields are 0.001 long at least, and positive definite up to their bounds") {
    const Metric at_layer = value_at(*ugawg_polar_2().field, {0.5, 0, 0.2});
    CHECK(at_layer == Metric{0.001, 0.025, 0.1, 0, 0, 0});
    for (const auto& field : {ugawg_linear(), ugawg_polar_1(), ugawg_polar_2()}) {
        CHECK(field.finest_length == 0.001);
        CHECK(field.field->domain() == Box{Point::Zero(), Point::Ones()});
        for (int i = 0; i < 8; ++i) {
            CHECK(is_positive_definite(value_at(*field.field, corner(field.field->domain(), i))));
        }
        Draw draw(4);
        double least = 1;
        for (int i = 0; i < 2000; ++i) {
            const auto lengths = eigen_frame(value_at(*field.field, place(draw))).lengths;
            least = std::min(least, lengths[0]);
        }
        CHECK(least >= 0.001 * (1 - 1e-12));
        CHECK(least < 0.0015);
    }
}

}  // namespace controlspace::ugawg_fields_test
