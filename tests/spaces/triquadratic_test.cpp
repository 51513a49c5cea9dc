// SPDX-License-Identifier: Apache-2.0
#include "trees/values/triquadratic.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "controlspace/metric/intersection.h"
#include "metric/draw.h"

namespace controlspace::triquadratic_test {
namespace {

using Across = std::array<Metric, 6>;

constexpr double unlimited = 1e300;

// Node (i, j, k), each -1, 0 or 1, of the 27-node hexahedron as the header words it.
Metric node(const Metric& own, const Across& across, const std::array<int, 3>& step) {
    Metric sum{0, 0, 0, 0, 0, 0};
    int faces = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        if (step[a] == 0) continue;
        const Metric& neighbour = across[2 * a + (step[a] > 0 ? 1 : 0)];
        sum = Metric::from_matrix(sum.matrix() + 0.5 * (own.matrix() + neighbour.matrix()));
        ++faces;
    }
    return faces == 0 ? own : (1.0 / faces) * sum;
}

// The sum over 27 nodes with triquadratic Lagrange functions.
Metric by_nodes(const Metric& own, const Across& across, const Vector& t) {
    const auto lagrange = [](int step, double s) {
        return step < 0 ? 0.5 * s * (s - 1) : step > 0 ? 0.5 * s * (s + 1) : 1 - s * s;
    };
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
            for (int k = -1; k <= 1; ++k) {
                sum += lagrange(i, t[0]) * lagrange(j, t[1]) * lagrange(k, t[2]) *
                       node(own, across, {i, j, k}).matrix();
            }
        }
    }
    return Metric::from_matrix(sum);
}

Across draw_across(Draw& draw, double size, double anisotropy) {
    Across across;
    for (Metric& m : across) m = draw.metric(size, anisotropy);
    return across;
}

}  // namespace

TEST_CASE("the sum over seven metrics is the one over 27 nodes") {
    Draw draw(1);
    for (int i = 0; i < 100; ++i) {
        const Metric own = draw.metric(1, 2);
        const Across across = draw_across(draw, 1, 2);
        const Vector t(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const Metric expected = by_nodes(own, across, t);
        const Eigen::Matrix3d above = expected.matrix() - 0.5 * own.matrix();
        if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(above).eigenvalues()[0] < 0) continue;
        CHECK(difference(triquadratic(own, across, t, unlimited), expected) < 1e-13);
    }
}

TEST_CASE("own metric at the centre, constants everywhere") {
    Draw draw(2);
    const Metric own = draw.metric(0.1, 100);
    CHECK(triquadratic(own, draw_across(draw, 1, 10), Vector::Zero(), 1) == own);
    Across constant;
    constant.fill(own);
    CHECK(difference(triquadratic(own, constant, Vector(0.3, -0.9, 0.5), 1), own) < 1e-14);
}

TEST_CASE("reflecting the axes reflects the field") {
    Draw draw(3);
    for (int i = 0; i < 50; ++i) {
        const Metric own = draw.metric(1, 1);
        Across across;
        for (Metric& m : across) m = Metric::isotropic(draw.uniform(0.5, 2));
        const Vector t(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const Metric here = triquadratic(own, across, t, unlimited);
        for (std::size_t a = 0; a < 3; ++a) {
            Across mirrored = across;
            std::swap(mirrored[2 * a], mirrored[2 * a + 1]);
            Vector s = t;
            s[static_cast<Eigen::Index>(a)] *= -1;
            CHECK(difference(triquadratic(own, mirrored, s, unlimited), here) < 1e-14);
        }
    }
}

TEST_CASE("never below half of the leaf's own metric, whatever the neighbours") {
    Draw draw(4);
    int undershoots = 0;
    for (int i = 0; i < 500; ++i) {
        const double anisotropy = i % 2 == 0 ? 1 : 100;
        const Metric own = draw.metric(0.01, anisotropy);
        Across across;
        for (Metric& m : across) {
            m = draw.uniform(0, 1) < 0.5 ? draw.metric(10, anisotropy)
                                         : draw.metric(0.01, anisotropy);
        }
        const Vector t(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const Metric m = triquadratic(own, across, t, unlimited);
        REQUIRE(is_positive_definite(m));
        // m >= own / 2 as matrices, up to rounding.
        const Eigen::Matrix3d above = m.matrix() - 0.5 * own.matrix();
        const double deepest =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(above).eigenvalues()[0];
        CHECK(deepest >= -1e-9 * m.matrix().norm());
        undershoots += difference(m, by_nodes(own, across, t)) > 1e-9;
    }
    CHECK(undershoots > 20);  // the case was met
}

TEST_CASE("never longer than the growth that is allowed, and the interpolation where it may be") {
    Draw draw(5);
    int limited = 0;
    for (int i = 0; i < 500; ++i) {
        const double anisotropy = i % 2 == 0 ? 1 : 30;
        const Metric own = draw.metric(0.1, anisotropy);
        const Across across = draw_across(draw, i % 3 == 0 ? 0.1 : 1, anisotropy);
        const Vector t(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const double allowed = draw.uniform(1, 3);
        const Metric free = triquadratic(own, across, t, unlimited);
        const Metric m = triquadratic(own, across, t, allowed);
        REQUIRE(is_positive_definite(m));
        CHECK(growth(m, own) <= allowed * (1 + 1e-9));
        if (growth(free, own) <= allowed) {
            CHECK(m == free);
        } else {
            ++limited;
            // Isotropic answers take what is allowed, no less.
            if (anisotropy == 1) CHECK(growth(m, own) == Approx(allowed));
        }
    }
    CHECK(limited > 100);
}

TEST_CASE("a limited growth makes no jump") {
    Draw draw(7);
    for (int i = 0; i < 300; ++i) {
        const double anisotropy = i % 2 == 0 ? 3 : 30;
        const Metric own = draw.metric(0.1, anisotropy);
        const Across across = draw_across(draw, 0.2, anisotropy);
        const Vector t(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const Metric free = triquadratic(own, across, t, unlimited);
        const double reached = growth(free, own);
        // A hair below what the interpolated metric reaches along one direction, and above.
        const Metric below = triquadratic(own, across, t, reached * (1 - 1e-9));
        CHECK(length_difference(below, free) < 1e-6);
        CHECK(triquadratic(own, across, t, reached * (1 + 1e-9)) == free);
        // The others keep what they have.
        if (reached < 1.3) continue;
        const Metric half = triquadratic(own, across, t, std::sqrt(reached));
        CHECK(growth(free, half) <= std::sqrt(reached) * (1 + 1e-6));
    }
}

TEST_CASE("lengths are interpolated as the isotropic metrics are, to the bit") {
    Draw draw(6);
    int deepened = 0, limited = 0, free = 0;
    for (int i = 0; i < 3000; ++i) {
        const double own = draw.uniform(0.01, 0.1);
        std::array<double, 6> lengths;
        const double longest = i % 3 == 0 ? 0.1 : 2;
        for (double& h : lengths) h = draw.uniform(0, 1) < 0.5 ? own : draw.uniform(0.01, longest);
        Across across;
        for (std::size_t k = 0; k < 6; ++k) across[k] = Metric::isotropic(lengths[k]);
        const Vector t(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        const Vector v = 0.1 * t;
        const double slope = draw.uniform(0, 1);
        const Metric own_metric = Metric::isotropic(own);
        const double growth_allowed = 1 + slope * metric_length(own_metric, v);
        const Metric expected = triquadratic(own_metric, across, t, growth_allowed);
        CHECK(Metric::isotropic(triquadratic(own, lengths, t, v, slope)) == expected);
        const Metric unchanged = by_nodes(own_metric, across, t);
        const bool is_deepened = expected.xx > 1.000001 * unchanged.xx;
        const bool is_limited = expected.xx < 0.999999 * unchanged.xx;
        deepened += is_deepened;
        limited += is_limited;
        free += !is_deepened && !is_limited;
    }
    CHECK(deepened > 100);
    CHECK(limited > 100);
    CHECK(free > 100);
}

}  // namespace controlspace::triquadratic_test
