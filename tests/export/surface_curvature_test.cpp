// SPDX-License-Identifier: Apache-2.0
// Curvature of surfaces in closed form, and creases.
#include <catch2/catch.hpp>
#include <cmath>

#include "controlspace/io/read_surface_sources.h"
#include "export/surfaces.h"
#include "sources/files.h"

namespace controlspace::surface_curvature_test {
namespace {

/// Lengths are radii: the chord of 60 degrees; no bounds, no walls.
constexpr CurvatureSizes radii{.angle = 60, .elements_across = 1e-3, .h_min = 1e-4, .h_max = 1e3};

constexpr double flat = 1e6;

/// Principal radii of curvature at a place, the smaller first; {0, 0} for places left out.
using Radii = std::function<std::array<double, 2>(const Point&)>;

struct Shape {
    std::string name;
    Surface (*make)(std::size_t n, double jitter);
    Radii radii;
};

std::vector<Shape> shapes() {
    constexpr std::array<double, 2> left_out{0, 0};
    return {
        {"sphere", [](std::size_t n, double jitter) { return sphere(n, n / 2 - 2, jitter); },
         [=](const Point& p) {
             return std::abs(p.z()) < 0.7 ? std::array{1.0, 1.0} : left_out;
         }},
        {"cylinder", [](std::size_t n, double jitter) { return cone(1, 1, 4, n, n, jitter); },
         [=](const Point& p) {
             return std::abs(p.z() - 2) < 1.6 ? std::array{1.0, flat} : left_out;
         }},
        {"cone", [](std::size_t n, double jitter) { return cone(1, 0.2, 1, n, n / 2, jitter); },
         [=](const Point& p) {
             const double r = std::hypot(p.x(), p.y()) * std::hypot(1, 0.8);
             return std::abs(p.z() - 0.5) < 0.3 ? std::array{r, flat} : left_out;
         }},
        {"torus", torus,
         [=](const Point& p) {
             const double r = std::hypot(p.x(), p.y()), cosine = std::abs(r - 3);
             return cosine > 0.5 ? std::array{1.0, r / cosine} : left_out;
         }},
    };
}

std::vector<PointSource> sources_of(const Surface& surface, const CurvatureSizes& sizes) {
    const ScratchDirectory scratch;
    const SurfaceSources read =
        read_surface_sources(scratch.file("s.off", off_text(surface)), sizes);
    CHECK(read.skipped == 0);
    return read.sources;
}

/// Largest relative errors of the radii of curvature; in flat directions, a radius as a part of
/// which the other is.
struct Errors {
    double curved = 0, flat = 0;
};
Errors errors_of(const Surface& surface, const Radii& radii_at, double scale) {
    const Eigen::Affine3d map = somewhere(scale);
    Errors worst;
    int seen = 0;
    for (const auto& [p, metric, own_growth] : sources_of(transformed(surface, map), radii)) {
        const auto expected = radii_at(map.inverse() * p);
        if (expected[0] == 0) continue;
        ++seen;
        const auto lengths = eigen_frame(metric).lengths;  // the one across comes first or second
        for (const std::size_t k : {0, 1}) {
            const double radius = lengths[2 * k] / scale;
            double& error = expected[k] < flat ? worst.curved : worst.flat;
            error = std::max(error, expected[k] < flat ? std::abs(radius / expected[k] - 1)
                                                       : expected[0] / radius);
        }
    }
    CHECK(seen > 40);
    return worst;
}

double finest(const Surface& surface, const CurvatureSizes& sizes) {
    return finest_length(sources_of(surface, sizes));
}

/// Two squares that meet at an edge where the normal turns by `degrees`.
Surface roof(double degrees, std::size_t n) {
    const double angle = degrees / 2 * pi / 180;
    return patch({2 * n, n}, [=](double u, double v) {
        const double x = 2 * u - 1;
        return Point(x * std::cos(angle), v, -std::abs(x) * std::sin(angle));
    });
}

}  // namespace

TEST_CASE("radii of curvature are those of the shape, at any refinement, place and scale") {
    const Shape shape = GENERATE(from_range(shapes()));
    const std::size_t n = GENERATE(24, 48, 96);
    const double jitter = GENERATE(0.0, 0.3);
    const Errors error = errors_of(shape.make(n, jitter), shape.radii, n == 48 ? 1 : 1e-3);
    CAPTURE(shape.name, n, jitter, error.curved, error.flat);
    CHECK(error.curved < 0.05);
    CHECK(error.flat < 0.025);
}

TEST_CASE("strips from rim to rim have the radius of their cylinder or cone all along") {
    const double top = GENERATE(1.0, 0.4);
    const double jitter = GENERATE(0.0, 0.3);
    const std::size_t n = GENERATE(24, 48, 96);
    const double slant = std::hypot(1, (1 - top) / 6);
    const auto error = errors_of(
        cone(1, top, 6, n, 1, jitter),
        [&](const Point& p) {
            return std::array{(1 + (top - 1) * p.z() / 6) * slant, flat};
        },
        1);
    CAPTURE(top, jitter, n, error.curved, error.flat);
    CHECK(error.curved < 0.05);
    CHECK(error.flat < 0.025);
}

TEST_CASE("lengths shrink towards an apex") {
    // Strips alone, which meet at the apex.
    const auto sources = sources_of(cone(1, 0, 2, 48, 1), {.angle = 60, .h_min = 1e-3, .h_max = 9});
    const double slant = std::hypot(1, 0.5);
    for (const auto& [p, metric, own_growth] : sources) {
        const double r = (1 - p.z() / 2) * slant;
        if (p.z() < 1.6) CHECK(eigen_frame(metric).lengths[0] == Approx(r).epsilon(0.05));
        if (p.z() == 2) CHECK(eigen_frame(metric).lengths[0] == Approx(1e-3));
    }
}

TEST_CASE("a cube has no curvature, however fine its faces are") {
    const std::size_t n = GENERATE(1, 5, 20, 100);
    const Surface cube = transformed(box({0, 0, 0}, {1, 1, 1}, n), somewhere(1));
    for (const auto& [p, metric, own_growth] : sources_of(cube, {.h_max = 0.2})) {
        REQUIRE(eigen_frame(metric).lengths[0] == Approx(0.2));
    }
}

TEST_CASE("a closed cylinder is curved around its axis, and its caps are flat") {
    Surface surface = cone(1, 1, 4, 48, 1);
    for (const double z : {0, 4}) {
        surface += patch({48, 1, true}, [&](double u, double v) {
            return Point(v * std::cos(2 * pi * u), v * std::sin(2 * pi * u), z);
        });
    }
    for (const auto& [p, metric, own_growth] : sources_of(surface, {.h_max = 0.4})) {
        const double r = std::hypot(p.x(), p.y());
        CAPTURE(p.x(), p.y(), p.z());
        const Vector around(-p.y(), p.x(), 0);
        if (r > 0.99) CHECK(metric_length(metric, around) == Approx(r / chord(15)).epsilon(0.01));
        if (r < 0.99) CHECK(metric_length(metric, around) == Approx(r / 0.4));
        CHECK(metric_length(metric, Vector::UnitZ()) == Approx(1 / 0.4).epsilon(0.01));
    }
}

TEST_CASE("an edge is a crease where the normal turns by more than the angle") {
    const double degrees = GENERATE(20, 25, 29, 31, 35, 40, 45);
    const std::size_t n = GENERATE(1, 8, 32);
    CAPTURE(degrees, n);
    const Surface surface = roof(degrees, n);
    const CurvatureSizes sizes{.h_max = 0.3};
    CHECK((finest(surface, sizes) < 0.29) == (degrees < 30 && n > 1));
    CurvatureSizes other = sizes;
    other.crease = degrees - 0.5;
    CHECK(finest(surface, other) == Approx(0.3));
    other.crease = degrees + 0.5;
    CHECK((finest(surface, other) < 0.29) == (n > 1));
    // What is flat on both sides stays so: two rows of triangles beside the edge are not.
    for (const auto& [p, metric, own_growth] : sources_of(surface, other)) {
        if (std::abs(p.x()) > 2.0 / double(n)) CHECK(finest_length({{{p, metric}}}) == Approx(0.3));
    }
}

TEST_CASE("a plate between fillets is flat, and so are the two halves of a fold") {
    // Half a stadium: a quarter circle of radius 0.1 on both sides of a square.
    const Surface surface = patch({26, 1}, [](double u, double v) {
        const double s = 26 * u;  // 12 strips, one wide, 12 strips, one wide
        const auto arc = [](double k) { return k * pi / 24; };
        if (s <= 12) return Point(-0.1 * std::cos(arc(s)), v, 0.1 * std::sin(arc(s)));
        if (s <= 25) return Point(1 + 0.1 * std::sin(arc(s - 13)), v, 0.1 * std::cos(arc(s - 13)));
        return Point(1.1, v, -1);
    });
    int flat_ones = 0;
    for (const auto& [p, metric, own_growth] : sources_of(surface, {.h_max = 0.2})) {
        const double shortest = eigen_frame(metric).lengths[0];
        if (p.x() > 0.01 && p.x() < 0.99) {
            CHECK(shortest > 0.15);
            ++flat_ones;
        }
        if (p.x() < -0.02 && p.x() > -0.09)
            CHECK(shortest == Approx(0.1 * chord(15)).epsilon(0.05));
    }
    CHECK(flat_ones > 5);
}

}  // namespace controlspace::surface_curvature_test
