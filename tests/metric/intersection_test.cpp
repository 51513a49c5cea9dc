// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/intersection.h"

#include <catch2/catch.hpp>
#include <vector>

#include "metric/decompose.h"
#include "metric/draw.h"

namespace controlspace::intersection_test {
namespace {

struct Pair {
    Metric a, b;
    double anisotropy;  ///< the larger of the two
    /// What rounding of six numbers may make of a length, with room for a few operations.
    double tolerance() const { return 1e-14 + 4e-15 * anisotropy; }
};

// Every kind of pair that has a case of its own: axis-aligned, isotropic, strongly anisotropic,
// far apart in size, nearly equal.
std::vector<Pair> pairs() {
    Draw draw(21);
    std::vector<Pair> all;
    for (double anisotropy : {1.0, 1 + 1e-13, 1 + 1e-7, 3.0, 1e3, 1e6}) {
        for (double size : {1e-6, 0.1, 1.0, 20.0, 1e6}) {
            for (int i = 0; i < 12; ++i) {
                const Metric a = draw.metric(1, anisotropy);
                const auto [h0, h1, h2] = draw.lengths(size, anisotropy);
                const Metric aligned{h0, h1, h2, 0, 0, 0};
                all.push_back({a, draw.metric(size, anisotropy), anisotropy});
                all.push_back({a, draw.metric(size, 2), std::max(anisotropy, 2.0)});
                all.push_back({a, aligned, anisotropy});
                all.push_back({{h1, h0, h2, 0, 0, 0}, aligned, anisotropy});
                all.push_back({a, Metric::isotropic(size), anisotropy});
                const Metric noise = draw.metric(1, 10);
                const double level = std::pow(10, draw.uniform(-16, -9)) / anisotropy;
                all.push_back(
                    {a, Metric::from_matrix(a.matrix() + level * noise.matrix()), anisotropy});
            }
        }
    }
    return all;
}

// The textbook formula in extended precision, squares and all.
Metric by_square_roots(const Metric& a, const Metric& b) {
    using Matrix = Eigen::Matrix<long double, 3, 3>;
    using Solver = Eigen::SelfAdjointEigenSolver<Matrix>;
    const Matrix root_inverse = a.matrix().cast<long double>();  // A^-1/2 = a
    const Matrix root = root_inverse.inverse();
    const Matrix b_inverse = b.matrix().cast<long double>().inverse();
    const Solver reduced(root_inverse * b_inverse * b_inverse * root_inverse);
    const Matrix cut = reduced.eigenvectors() * reduced.eigenvalues().cwiseMax(1.0L).asDiagonal() *
                       reduced.eigenvectors().transpose();
    return Metric::from_matrix(
        Solver(root * cut * root).operatorInverseSqrt().template cast<double>());
}

}  // namespace

TEST_CASE("intersection is positive definite and within both") {
    for (const Pair& p : pairs()) {
        const Metric m = intersection(p.a, p.b);
        CAPTURE(to_string(p.a), to_string(p.b), to_string(m));
        REQUIRE(is_positive_definite(m));
        CHECK(growth(m, p.a) <= 1 + p.tolerance());
        CHECK(growth(m, p.b) <= 1 + p.tolerance());
        CHECK(is_within(m, 1, p.a));
        CHECK(is_within(m, 1, p.b));
    }
}

TEST_CASE("intersection is never longer along any direction") {
    Draw draw(22);
    for (const Pair& p : pairs()) {
        const Metric m = intersection(p.a, p.b);
        for (int i = 0; i < 5; ++i) {
            const Vector v = draw.vector();
            const double longest = std::max(metric_length(p.a, v), metric_length(p.b, v));
            CHECK(metric_length(m, v) >= longest * (1 - p.tolerance()));
        }
    }
}

TEST_CASE("intersection touches one of the two along each reduced direction") {
    // The largest such metric: |m^-1 v| = max over the two along the three directions that are
    // conjugate in both, which are the eigenvectors of b^2 a^-2.
    Draw draw(23);
    for (int i = 0; i < 200; ++i) {
        const Metric a = draw.metric(1, 10);
        const Metric b = draw.metric(1, 10);
        const Metric m = intersection(a, b);
        const Eigen::Matrix3d squares =
            b.matrix() * b.matrix() * (a.matrix() * a.matrix()).inverse();
        const Eigen::EigenSolver<Eigen::Matrix3d> conjugate(squares);
        for (int k = 0; k < 3; ++k) {
            const Vector v = conjugate.eigenvectors().col(k).real();
            CHECK(metric_length(m, v) ==
                  Approx(std::max(metric_length(a, v), metric_length(b, v))).epsilon(1e-10));
        }
    }
}

TEST_CASE("intersection is symmetric") {
    for (const Pair& p : pairs()) {
        CAPTURE(to_string(p.a), to_string(p.b));
        CHECK(length_difference(intersection(p.a, p.b), intersection(p.b, p.a)) <=
              2 * p.tolerance());
    }
}

TEST_CASE("intersection with itself or a larger multiple is itself, to the bit") {
    for (const Pair& p : pairs()) {
        CAPTURE(to_string(p.a));
        CHECK(intersection(p.a, p.a) == p.a);
        for (double k : {1 + 1e-15, 1.5, 2.0, 1e6}) {
            CHECK(intersection(p.a, k * p.a) == p.a);
            CHECK(length_difference(intersection(k * p.a, p.a), p.a) <= p.tolerance());
        }
    }
}

TEST_CASE("intersection absorbs: what was cut by b is within b for good") {
    for (const Pair& p : pairs()) {
        const Metric m = intersection(p.a, p.b);
        CHECK(length_difference(intersection(m, p.b), m) <= 4 * p.tolerance());
        CHECK(length_difference(intersection(m, p.a), m) <= 4 * p.tolerance());
    }
}

TEST_CASE("intersection turns with its arguments") {
    // Turning rounds the six numbers once more, hence the wider tolerance. It also takes the
    // axis-aligned and isotropic pairs out of their fast paths.
    Draw draw(24);
    for (const Pair& p : pairs()) {
        const Eigen::Matrix3d r = draw.rotation();
        const Metric turned = intersection(rotated(p.a, r), rotated(p.b, r));
        CAPTURE(to_string(p.a), to_string(p.b));
        CHECK(length_difference(turned, rotated(intersection(p.a, p.b), r)) <= 3 * p.tolerance());
    }
}

TEST_CASE("intersection scales with its arguments") {
    for (const Pair& p : pairs()) {
        const double k = 0x1p-30;  // a power of 2: no rounding
        CHECK(intersection(k * p.a, k * p.b) == k * intersection(p.a, p.b));
    }
}

TEST_CASE("intersection agrees with the formula in extended precision") {
    for (const Pair& p : pairs()) {
        if (p.anisotropy > 1e3) continue;  // the formula squares the anisotropy
        CAPTURE(to_string(p.a), to_string(p.b));
        CHECK(length_difference(intersection(p.a, p.b), by_square_roots(p.a, p.b)) <=
              p.tolerance() + 1e-19 * std::pow(p.anisotropy, 4));
    }
}

TEST_CASE("intersection shrinks with its arguments") {
    // In the same frame only: in general the reduction is not monotone, as sqrt-type means are not.
    Draw draw(25);
    for (int i = 0; i < 200; ++i) {
        const Metric a = draw.metric(1, 100);
        const Metric b = draw.metric(1, 100);
        for (double k : {0.2, 0.9}) {
            const Metric smaller = intersection(k * a, k * b);
            CHECK(is_within(smaller, k * (1 + 1e-12), intersection(a, b)));
        }
        const double h = draw.uniform(0.1, 2);
        CHECK(is_within(intersection(a, Metric::isotropic(0.8 * h)), 1,
                        intersection(a, Metric::isotropic(h))));
    }
}

TEST_CASE("published check values of intersection") {
    const Metric first =
        intersection({0.175, 0.325, 0.2, -0.129903811, 0, 0}, {0.3, 0.15, 0.25, 0, 0, 0});
    CHECK(difference(first, {0.12723169, 0.140748046, 0.2, -0.0367564158, 0, 0}) < 1e-8);
    const Metric second = intersection(
        {0.189285714, 0.157142857, 0.103571429, -0.0214285714, -0.0321428571, -0.0642857143},
        {0.3, 0.15, 0.15, -0.1, -0.1, 0.05});
    CHECK(difference(second, {0.187952381, 0.0918095238, 0.0702380952, -0.0307619048, -0.0254761905,
                              -0.0176190476}) < 1e-7);
}

TEST_CASE("growth and is_within are what intersection does") {
    for (const Pair& p : pairs()) {
        const double k = growth(p.a, p.b);
        CAPTURE(to_string(p.a), to_string(p.b), k);
        CHECK(is_within(p.a, k, p.b));
        CHECK(is_within(p.a, k * (1 + 1e-3), p.b));
        if (p.anisotropy < 1e6) CHECK_FALSE(is_within(p.a, k * (1 - 1e-3), p.b));
        CHECK(length_difference(intersection(p.a, k * p.b), p.a) <= 2 * p.tolerance());
        if (p.anisotropy < 1e6) {
            CHECK_FALSE(intersection(p.a, 0.999 * k * p.b) == p.a);
        }
    }
}

TEST_CASE("growth of closed forms") {
    CHECK(growth({1, 2, 3, 0, 0, 0}, {4, 1, 2, 0, 0, 0}) == 2);
    CHECK(growth(Metric::isotropic(1), Metric::isotropic(4)) == 0.25);
    // 1 and 3 in the x-y plane, against 2.
    CHECK(growth({2, 2, 1, 1, 0, 0}, Metric::isotropic(2)) == Approx(1.5).epsilon(1e-15));
    CHECK(growth(Metric::isotropic(2), {2, 2, 2, 1, 0, 0}) == Approx(2).epsilon(1e-15));
}

}  // namespace controlspace::intersection_test
