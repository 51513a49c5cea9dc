// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/sampled_surfaces.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>

#include "sources/files.h"

namespace controlspace::sampled_surfaces_test {
namespace {

// Whether `m` has length `across` along the unit vector `n`, and `along` at right angles to it.
bool is_surface_metric(const Metric& m, const Vector& n, double across, double along) {
    const Eigen::Matrix3d projector = n * n.transpose();
    const Eigen::Matrix3d expected =
        across * projector + along * (Eigen::Matrix3d::Identity() - projector);
    return (m.matrix() - expected).cwiseAbs().maxCoeff() <= 1e-15 * std::max(across, along);
}

std::size_t distinct_places(const std::vector<PointSource>& sources) {
    std::set<std::tuple<double, double, double>> places;
    for (const PointSource& s : sources) {
        places.emplace(s.position.x(), s.position.y(), s.position.z());
    }
    return places.size();
}

}  // namespace

TEST_CASE("the published sphere has the published number of sources") {
    // Counts of the runs behind the paper's tables, coincident ones included.
    CHECK(sample_sphere({.rho = 1}).size() == 36186);
    CHECK(sample_sphere({.rho = 0.5}).size() == 144002);
    CHECK(sample_sphere({.rho = 0.2}).size() == 895534);
}

TEST_CASE("sphere sources lie on the sphere and are isotropic 0.03 by default") {
    for (const PointSource& s : sample_sphere({})) {
        REQUIRE(std::abs(s.position.norm() - 0.8) < 1e-15);
        REQUIRE(s.metric == Metric::isotropic(0.03));
    }
}

TEST_CASE("sphere sources have their lengths across and along") {
    for (const PointSource& s : sample_sphere({.radius = 0.5, .s_a = 4, .s_n = 0.25, .rho = 3})) {
        REQUIRE(is_surface_metric(s.metric, s.position / 0.5, 0.015, 0.06));
        const EigenFrame frame = eigen_frame(s.metric);
        REQUIRE(frame.lengths[0] == Approx(0.015).epsilon(1e-14));
        REQUIRE(frame.lengths[1] == Approx(0.06).epsilon(1e-14));
        REQUIRE(frame.lengths[2] == Approx(0.06).epsilon(1e-14));
        REQUIRE(std::abs(frame.directions.col(0).dot(s.position)) == Approx(0.5).epsilon(1e-14));
    }
    CHECK(finest_length(sample_sphere({.s_a = 4, .s_n = 0.25, .rho = 3})) ==
          Approx(0.015).epsilon(1e-14));
}

TEST_CASE("sphere sources come in the published order") {
    const std::vector<PointSource> sources = sample_sphere({});
    // n = 1 + floor(pi/2 0.8 / 0.015) = 84 steps a quarter.
    const double step = std::numbers::pi / 2 / 84;
    const auto position = [&](std::size_t i) { return sources[i].position; };
    CHECK(position(0).isApprox(Point(0, 0.8, 0)));
    CHECK(position(1).isApprox(Point(0, -0.8, 0)));
    CHECK(position(2).isApprox(Point(0, 0.8, 0)));
    CHECK(position(4).isApprox(0.8 * Point(std::sin(step), std::cos(step), 0)));
    CHECK(position(5).isApprox(0.8 * Point(std::sin(step), -std::cos(step), 0)));
    CHECK(position(6).isApprox(0.8 * Point(-std::sin(step), std::cos(step), 0)));
    // The first latitude follows the equator's 84 x 4.
    CHECK(position(84 * 4).isApprox(0.8 * Point(0, std::cos(step), std::sin(step))));
    CHECK(position(84 * 4 + 4).isApprox(0.8 * Point(0, std::cos(step), -std::sin(step))));
    CHECK(position(sources.size() - 2) == Point(0, 0, 0.8));
    CHECK(position(sources.size() - 1) == Point(0, 0, -0.8));
}

TEST_CASE("sphere sources leave no gap but the published one") {
    // From any place on the sphere to the nearest source: half the diagonal of a spacing; beside
    // the meridian y = 0, where two steps meet without a source, half of a 2 x 1 one's.
    const std::vector<PointSource> sources = sample_sphere({.rho = 4});
    const double spacing = 4 * 0.015;
    for (int i = 0; i < 200; ++i) {
        const double z = -1 + (i + 0.5) / 100;
        const double angle = 2.399963 * i;  // the golden angle
        const double r = std::sqrt(1 - z * z);
        const Point p = 0.8 * Point(r * std::cos(angle), r * std::sin(angle), z);
        double nearest = 10;
        for (const PointSource& s : sources) nearest = std::min(nearest, (s.position - p).norm());
        const double steps = std::abs(p.y()) < spacing ? std::sqrt(1.25) : std::sqrt(0.5);
        CHECK(nearest <= steps * spacing);
    }
}

TEST_CASE("plane sources lie on both planes, the first plane first") {
    const std::vector<PointSource> sources = sample_planes({.slope = 0.5});
    std::size_t first = 0;
    while (first < sources.size() && sources[first].position.x() == -0.5) ++first;
    CHECK(first == 135 * 135);
    const std::size_t columns = 151;  // 1 + ceil(2 sqrt(1.25) / 0.015)
    CHECK(sources.size() == 135 * 135 + columns * 135);
    for (std::size_t i = first; i < sources.size(); ++i) {
        const Point& p = sources[i].position;
        REQUIRE(p.y() == Approx(-0.2 + 0.5 * p.x()).margin(1e-15));
    }
    for (const PointSource& s : sources) {
        REQUIRE(s.position.cwiseAbs().maxCoeff() <= 1);
        REQUIRE(s.metric == Metric::isotropic(0.03));
    }
    CHECK(distinct_places(sources) == sources.size());
    CHECK(sources[0].position == Point(-0.5, -1, -1));
    CHECK(sources[1].position.isApprox(Point(-0.5, -1 + 0.015, -1)));
    CHECK(sources[134].position == Point(-0.5, 1, -1));
    CHECK(sources[135].position.isApprox(Point(-0.5, -1, -1 + 0.015)));
    CHECK(sources[first].position.isApprox(Point(-1, -0.7, -1)));
    CHECK(sources.back().position.isApprox(Point(1, 0.3, 1)));
}

TEST_CASE("plane sources have their lengths across and along") {
    for (double slope : {0.0, 0.8, -0.3}) {
        const Vector normal = Vector(slope, -1, 0).normalized();
        for (const PointSource& s :
             sample_planes({.s_a = 4, .s_n = 0.25, .rho = 5, .slope = slope})) {
            const bool on_first = s.position.x() == -0.5;
            // A few sources of the second plane may lie on the first as well.
            REQUIRE((is_surface_metric(s.metric, normal, 0.015, 0.06) ||
                     (on_first && s.metric == Metric{0.015, 0.06, 0.06, 0, 0, 0})));
        }
    }
}

TEST_CASE("a spacing that divides the edge makes no double at its end") {
    const std::vector<PointSource> sources = sample_planes({.h = 0.1, .rho = 1});
    CHECK(sources.size() == 2 * 21 * 21);
    CHECK(sample_planes({.h = 5, .rho = 1}).size() == 2 * 2 * 2);
}

TEST_CASE("sampling refuses what it cannot do") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        CHECK_THROWS_AS(sample_sphere({.radius = bad}), InputError);
        CHECK_THROWS_AS(sample_sphere({.h = bad}), InputError);
        CHECK_THROWS_AS(sample_sphere({.s_a = bad}), InputError);
        CHECK_THROWS_AS(sample_sphere({.s_n = bad}), InputError);
        CHECK_THROWS_AS(sample_sphere({.rho = bad}), InputError);
        CHECK_THROWS_AS(sample_planes({.h = bad}), InputError);
    }
    CHECK(error_of([] { sample_sphere({.rho = 1e-9}); }).find("larger rho") != std::string::npos);
    CHECK(error_of([] { sample_planes({.rho = 1e-9}); }).find("larger rho") != std::string::npos);
    CHECK(error_of([] { sample_planes({.slope = 0.9}); }).find("slope = 0.9") != std::string::npos);
    CHECK_THROWS_AS(sample_planes({.slope = nan}), InputError);
    CHECK_THROWS_AS(finest_length({}), InputError);
}

}  // namespace controlspace::sampled_surfaces_test
