// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/scattered_surfaces.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "sources/files.h"

namespace controlspace::scattered_surfaces_test {
namespace {

constexpr Sampling irregular[] = {Sampling::random, Sampling::clustered, Sampling::poisson};

std::size_t count_within(const std::vector<PointSource>& sources, const Point& p, double radius) {
    return static_cast<std::size_t>(
        std::count_if(sources.begin(), sources.end(),
                      [&](const PointSource& s) { return (s.position - p).norm() < radius; }));
}

// n unit vectors spread over the sphere: a spiral by the golden angle.
std::vector<Vector> spread_directions(int n) {
    std::vector<Vector> directions;
    for (int i = 0; i < n; ++i) {
        const double z = -1 + (i + 0.5) * 2 / n;
        const double r = std::sqrt(1 - z * z);
        directions.emplace_back(r * std::cos(2.399963 * i), r * std::sin(2.399963 * i), z);
    }
    return directions;
}

double smallest_distance(const std::vector<PointSource>& sources) {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            smallest = std::min(smallest, (sources[i].position - sources[j].position).norm());
        }
    }
    return smallest;
}

}  // namespace

TEST_CASE("scattered sources lie on the sphere, with the metrics of those in rows") {
    const Point centre(0.5, -2, 7);
    for (const Sampling sampling : irregular) {
        const auto sources = scatter_sphere(
            {.centre = centre, .radius = 0.5, .s_a = 4, .s_n = 0.25, .rho = 3}, sampling, 1);
        REQUIRE(sources.size() > 500);
        for (const PointSource& s : sources) {
            const Vector v = s.position - centre;
            REQUIRE(v.norm() == Approx(0.5).epsilon(1e-14));
            const Vector across = s.metric.matrix() * v;
            REQUIRE((across - 0.015 * v).norm() < 1e-16);
            REQUIRE(s.metric.xx + s.metric.yy + s.metric.zz == Approx(0.015 + 2 * 0.06));
            REQUIRE(eigen_frame(s.metric).lengths[2] == Approx(0.06).epsilon(1e-14));
        }
    }
}

TEST_CASE("scattered sources lie on both planes by their areas") {
    for (const Sampling sampling : irregular) {
        const auto sources =
            scatter_planes({.s_a = 4, .s_n = 0.25, .rho = 2, .slope = 0.75}, sampling, 1);
        std::size_t first = 0;
        for (const PointSource& s : sources) {
            REQUIRE(s.position.cwiseAbs().maxCoeff() <= 1);
            if (s.position.x() == -0.5 && s.metric == Metric{0.015, 0.06, 0.06, 0, 0, 0}) {
                ++first;
                continue;
            }
            REQUIRE(s.position.y() == Approx(-0.2 + 0.75 * s.position.x()).margin(1e-14));
            const Vector normal = Vector(0.75, -1, 0).normalized();
            REQUIRE((s.metric.matrix() * normal - 0.015 * normal).norm() < 1e-16);
        }
        if (sampling == Sampling::clustered) continue;
        // Areas 4 and 4 * 1.25.
        const auto n = static_cast<double>(sources.size());
        CHECK(std::abs(static_cast<double>(first) - n / 2.25) < 5 * std::sqrt(n) / 2);
    }
}

TEST_CASE("random and clustered sources are as many as those in rows") {
    for (const Sampling sampling : {Sampling::random, Sampling::clustered}) {
        CHECK(scatter_sphere({.rho = 2}, sampling, 1).size() == sample_sphere({.rho = 2}).size());
        CHECK(scatter_planes({.rho = 3}, sampling, 1).size() == sample_planes({.rho = 3}).size());
    }
}

TEST_CASE("random sources fall into caps by their areas") {
    const auto sources = scatter_sphere({}, Sampling::random, 1);
    const auto n = static_cast<double>(sources.size());
    for (const double radius : {0.1, 0.4, 0.8}) {
        // Archimedes: the cap cut off by a ball of that radius has the area pi radius^2.
        const double share = radius * radius / (4 * 0.8 * 0.8);
        const double deviation = std::sqrt(n * share * (1 - share));
        for (const Vector& d : spread_directions(50)) {
            const auto count = static_cast<double>(count_within(sources, 0.8 * d, radius));
            CHECK(std::abs(count - n * share) < 5 * deviation);
        }
    }
}

TEST_CASE("Poisson sources keep their distance, leave no room, and fall evenly") {
    const SphereSampling sphere{.rho = 2};
    const double spacing = 0.03;
    const auto sources = scatter_sphere(sphere, Sampling::poisson, 1);
    CHECK(smallest_distance(sources) >= spacing);
    const auto regular = static_cast<double>(sample_sphere(sphere).size());
    const auto n = static_cast<double>(sources.size());
    // Random sequential adsorption of disks jams at 0.547 of the area: 0.696 a square of the
    // spacing (Feder 1980).
    CHECK(n < 0.696 * regular);
    CHECK(n > 0.57 * regular);
    const double share = 0.01 / (4 * 0.64);
    for (const Vector& d : spread_directions(400)) {
        CHECK(count_within(sources, 0.8 * d, 2 * spacing) > 0);
        // Half a standard deviation of independent sources, times five.
        const auto count = static_cast<double>(count_within(sources, 0.8 * d, 0.1));
        CHECK(std::abs(count - n * share) < 5 * 0.5 * std::sqrt(n * share));
    }
    CHECK(smallest_distance(scatter_planes({.rho = 3, .slope = 0.8}, Sampling::poisson, 2)) >=
          0.045);
}

TEST_CASE("clustered sources are normal around places that are random") {
    // The clusters' centres are drawn first, as random sources are.
    const auto random = scatter_sphere({.rho = 2}, Sampling::random, 4);
    const auto sources = scatter_sphere({.rho = 2}, Sampling::clustered, 4);
    const double spread = cluster_spread * std::sqrt(4 * std::numbers::pi) * 0.8;
    double far = 0;
    for (const PointSource& s : sources) {
        double nearest = 10;
        for (std::size_t i = 0; i < static_cast<std::size_t>(cluster_count); ++i) {
            nearest = std::min(nearest, (random[i].position - s.position).norm());
        }
        far += nearest > 3 * spread ? 1 : 0;
    }
    const auto n = static_cast<double>(sources.size());
    CHECK(far / n < 0.02);  // exp(-4.5) = 0.011 of a normal distribution, where none overlap
    CHECK(far / n > 0.001);
    // A lone cluster: within r of its centre are 1 - exp(-r^2 / (2 spread^2)).
    double lone = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(cluster_count); ++i) {
        double nearest = 10;
        for (std::size_t j = 0; j < static_cast<std::size_t>(cluster_count); ++j) {
            const double d = (random[i].position - random[j].position).norm();
            if (i != j) nearest = std::min(nearest, d);
        }
        if (nearest < 4.5 * spread) continue;
        ++lone;
        const auto count = static_cast<double>(count_within(sources, random[i].position, spread));
        CHECK(count / n == Approx((1 - std::exp(-0.5)) / cluster_count).epsilon(0.2));
    }
    CHECK(lone > 0);
}

TEST_CASE("scattered sources depend on the seed, and on nothing else") {
    for (const Sampling sampling : irregular) {
        const auto sources = scatter_sphere({.rho = 5}, sampling, 1);
        CHECK(sources == scatter_sphere({.rho = 5}, sampling, 1));
        CHECK_FALSE(sources == scatter_sphere({.rho = 5}, sampling, 2));
    }
}

TEST_CASE("regular sampling is that in rows") {
    CHECK(scatter_sphere({.rho = 5}, Sampling::regular, 1) == sample_sphere({.rho = 5}));
    CHECK(scatter_planes({.rho = 9, .slope = 0.5}, Sampling::regular, 1) ==
          sample_planes({.rho = 9, .slope = 0.5}));
}

TEST_CASE("scattering refuses what sampling refuses") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Sampling sampling : irregular) {
        CHECK_THROWS_AS(scatter_sphere({.radius = 0}, sampling, 1), InputError);
        CHECK_THROWS_AS(scatter_sphere({.s_n = nan}, sampling, 1), InputError);
        CHECK_THROWS_AS(scatter_planes({.h = -1}, sampling, 1), InputError);
        CHECK_THROWS_AS(scatter_planes({.slope = 2}, sampling, 1), InputError);
        CHECK(error_of([&] {
                  scatter_sphere({.centre = Point(0, nan, 0)}, sampling, 1);
              }).find("centre = (0, nan, 0)") != std::string::npos);
    }
}

}  // namespace controlspace::scattered_surfaces_test
