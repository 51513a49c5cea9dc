// SPDX-License-Identifier: Apache-2.0
#include "controlspace/mesh/conformity.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "controlspace/error.h"
#include "controlspace/fields/formula_field.h"
#include "mesh/fixtures.h"

namespace controlspace::conformity_test {
namespace {

/// Regular, of edge √8.
const std::array<Point, 4> regular{Point(1, 1, 1), Point(-1, 1, -1), Point(1, -1, -1),
                                   Point(-1, -1, 1)};

template <class Map>
std::array<Point, 4> mapped(const std::array<Point, 4>& corners, Map&& map) {
    std::array<Point, 4> result;
    std::transform(corners.begin(), corners.end(), result.begin(), map);
    return result;
}

}  // namespace

TEST_CASE("quality is 1 for what is regular in the metric, and only for that") {
    CHECK(tet_quality(regular, Metric::isotropic(0.3)) == Approx(1));
    const Metric skew = skew_metric({0.3, 0.2, 0.1});
    const Eigen::Matrix3d m = skew.matrix();
    const auto stretched = mapped(regular, [&](const Point& p) { return Point(m * p); });
    CHECK(tet_quality(stretched, skew) == Approx(1));
    CHECK(tet_quality(stretched, Metric::isotropic(1)) < 0.99);
    // Nor do place and size matter.
    const auto moved =
        mapped(stretched, [](const Point& p) { return Point(5 * p + Point::Ones()); });
    CHECK(tet_quality(moved, skew) == Approx(1));
    const auto corner =
        std::array<Point, 4>{Point::Zero(), Point::UnitX(), Point::UnitY(), Point::UnitZ()};
    // V = 1/6, Σ l² = 9.
    CHECK(tet_quality(corner, Metric::isotropic(2)) ==
          Approx(4 * std::pow(3, -1.0 / 3) * std::pow(6, -2.0 / 3)));
    const auto flat = mapped(corner, [](const Point& p) { return Point(p.x(), p.y(), 0); });
    CHECK(tet_quality(flat, Metric::isotropic(1)) == 0);
}

TEST_CASE("the length of an edge is the integral along it") {
    const Point a(0.1, 0.2, 0.3), b(0.15, 0.23, 0.28);
    const Metric m = skew_metric(a);
    CHECK(edge_length(a, b, m, m, m) == Approx(metric_length(m, b - a)));
    // h = 1 + s along an edge of length 1: the integral of 1 / h is log 2.
    const auto h = [](double s) { return Metric::isotropic(1 + s); };
    CHECK(edge_length(Point::Zero(), Point::UnitX(), h(0), h(0.5), h(1)) ==
          Approx(std::log(2.0)).epsilon(0.003));
}

TEST_CASE("edges are counted by their metric lengths", "[threads]") {
    const VertexIndex n = 4;
    const TetMesh mesh = kuhn_mesh(n);
    // Axes, face diagonals and body diagonals of the cells.
    const double axes = 3 * n * (n + 1) * (n + 1), faces = 3 * n * n * (n + 1), bodies = n * n * n;
    const double all = axes + faces + bodies;
    const auto measured = [&](double h) {
        const FormulaField field([&](const Point&) { return Metric::isotropic(h / n); });
        return conformity(mesh, field);
    };
    const Conformity at_axes = measured(0.95);  // lengths 1.05, 1.49, 1.82
    CHECK(at_axes.nodes == (n + 1) * (n + 1) * (n + 1));
    CHECK(at_axes.tets == 6 * n * n * n);
    CHECK(static_cast<double>(at_axes.edges) == all);
    CHECK(at_axes.l_r == Approx(axes / all));
    CHECK(at_axes.l_r_middle == Approx(axes / all));
    CHECK(at_axes.unit_share == Approx(axes / all));
    const double total = axes + faces * std::sqrt(2.0) + bodies * std::sqrt(3.0);
    CHECK(at_axes.mean_length == Approx(total / all / 0.95));

    const Conformity at_faces = measured(1.4);  // lengths 0.714, 1.01, 1.237
    CHECK(at_faces.l_r == Approx((faces + bodies) / all));
    CHECK(at_faces.unit_share == 1);
    const auto& classes = at_faces.histogram;
    CHECK(static_cast<double>(classes[3]) == axes);    // 1/√2 to 0.8
    CHECK(static_cast<double>(classes[6]) == faces);   // 1 to 1.1
    CHECK(static_cast<double>(classes[7]) == bodies);  // 1.1 to 1.25
    CHECK(std::accumulate(classes.begin(), classes.end(), std::size_t{0}) == at_faces.edges);

    // All cells are cut alike, so all tetrahedra have the same quality.
    CHECK(at_axes.quality_min == Approx(at_axes.quality_mean));
    CHECK(at_axes.quality_mean == Approx(at_faces.quality_mean));
}

TEST_CASE("the metric at an edge's middle and the metrics along it may judge differently") {
    const TetMesh mesh{
        {Point(0, 0, 0), Point(1, 0, 0), Point(0, 9, 0), Point(0, 0, 9)}, {}, {{0, 1, 2, 3}}};
    // The edge of length 1; the others are far longer.
    const auto measured = [&](double h_at_end) {
        const FormulaField field([&](const Point& p) {
            return Metric::isotropic(p.x() == 0 ? 2.0 : p.x() == 1 ? h_at_end : 0.9);
        });
        return conformity(mesh, field);
    };
    CHECK(measured(0.5).l_r == Approx(1.0 / 6));  // (1/2 + 4/0.9 + 1/0.5) / 6 = 1.157
    CHECK(measured(0.3).l_r == 0);                // 1.380
    CHECK(measured(0.3).l_r_middle == Approx(1.0 / 6));
}

TEST_CASE("a mesh without tetrahedra is refused") {
    const FormulaField field([](const Point&) { return Metric::isotropic(1); });
    CHECK_THROWS_AS(conformity(TetMesh{}, field), InputError);
}

}  // namespace controlspace::conformity_test
