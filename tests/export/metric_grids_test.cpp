// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/metric_grids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <string_view>

namespace controlspace::metric_grids_test {
namespace {

std::array<double, 3> value(std::string_view name, const Metric& m) {
    const auto grids = metric_grids();
    const auto grid = std::find_if(grids.begin(), grids.end(),
                                   [&](const MetricGrid& g) { return g.name == name; });
    REQUIRE(grid != grids.end());
    return grid->value(m, eigen_frame(m));
}

}  // namespace

TEST_CASE("grids hold what their names say") {
    // Lengths 0.1, 0.2, 0.4 along a turned frame.
    const Eigen::Matrix3d frame =
        Eigen::Quaterniond(0.5, 0.1, -0.7, 0.3).normalized().toRotationMatrix();
    const Metric m = metric_from_frame({0.1, 0.2, 0.4}, frame);
    CHECK(value("density", m)[0] == Approx(0.1));
    CHECK(value("h_min", m)[0] == Approx(0.1));
    CHECK(value("h_max", m)[0] == Approx(0.4));
    CHECK(value("h_mean", m)[0] == Approx(0.7 / 3));
    CHECK(value("anisotropy", m)[0] == Approx(4));
    const auto sizes = value("sizes", m);
    CHECK(sizes[0] == Approx(0.1));
    CHECK(sizes[1] == Approx(0.2));
    CHECK(sizes[2] == Approx(0.4));
    const auto e = value("e1", m);
    CHECK(std::abs(Vector(e[0], e[1], e[2]).dot(frame.col(0))) == Approx(1));
    CHECK(Vector(e[0], e[1], e[2]).cwiseAbs().maxCoeff() == Vector(e[0], e[1], e[2]).maxCoeff());
    CHECK(value("metric_diag", m) == std::array{m.xx, m.yy, m.zz});
    CHECK(value("metric_off", m) == std::array{m.xy, m.xz, m.yz});
}

TEST_CASE("no direction where all lengths are the same, and twins agree there") {
    const Metric m = Metric::isotropic(0.3);
    CHECK(value("e1", m) == std::array{0.0, 0.0, 0.0});
    int twins = 0;
    for (const MetricGrid& grid : metric_grids()) {
        if (grid.isotropic_twin.empty()) continue;
        ++twins;
        const auto own = value(grid.name, m);
        const auto other = value(grid.isotropic_twin, m);
        for (std::size_t i = 0; i < 3; ++i) CHECK(own[i] == Approx(other[i]).epsilon(1e-15));
    }
    CHECK(twins == 3);
}

TEST_CASE("density is 1 where finest, 0 where coarsest, and leads back to the length") {
    CHECK(density_of(0.01, 0.01, 1) == 1);
    CHECK(density_of(1, 0.01, 1) == 0);
    CHECK(density_of(0.1, 0.01, 1) == Approx(0.5));
    CHECK(density_of(0.5, 0.5, 0.5) == 1);
    for (const double h : {0.01, 0.02, 0.3, 1.0}) {
        CHECK(length_of_density(density_of(h, 0.01, 1), 0.01, 1) == Approx(h));
    }
    CHECK(length_of_density(-3, 0.01, 1) == 1);
    CHECK(length_of_density(7, 0.01, 1) == Approx(0.01));
}

}  // namespace controlspace::metric_grids_test
