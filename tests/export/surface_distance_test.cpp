// SPDX-License-Identifier: Apache-2.0
#include "io/surface/surface_distance.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "metric/draw.h"

namespace controlspace::surface_distance_test {
namespace {

/// By the smallest distance from the plane, where the foot is inside, from the edges otherwise.
double distance_from_triangle(const Point& x, const Point& a, const Point& b, const Point& c) {
    const auto to_edge = [&](const Point& p, const Point& q) {
        const double t = std::clamp((x - p).dot(q - p) / (q - p).squaredNorm(), 0.0, 1.0);
        return (x - p - t * (q - p)).norm();
    };
    const Vector normal = (b - a).cross(c - a).normalized();
    const auto is_left = [&](const Point& p, const Point& q) {
        return normal.cross(q - p).dot(x - p) >= 0;
    };
    if (is_left(a, b) && is_left(b, c) && is_left(c, a)) return std::abs(normal.dot(x - a));
    return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace

TEST_CASE("the distance from a surface is the smallest from its triangles") {
    Draw draw(1);
    SurfaceMesh mesh;
    for (std::uint32_t t = 0; t < 60; ++t) {
        const Point middle = draw.vector();
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(middle + 0.3 * draw.vector());
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const DistanceField field = surface_distance(mesh);
    for (const Point& v : mesh.vertices) {
        CHECK(field.distance(v) < 1e-12);
        CHECK(field.box.contains(v));
    }
    CHECK(field.places.size() == mesh.vertices.size());
    for (int i = 0; i < 1000; ++i) {
        const Point x = 2 * draw.vector();
        double nearest = 1e9;
        for (const auto& [a, b, c] : mesh.triangles) {
            nearest = std::min(nearest, distance_from_triangle(x, mesh.vertices[a],
                                                               mesh.vertices[b], mesh.vertices[c]));
        }
        CHECK(field.distance(x) == Approx(nearest).epsilon(1e-12).margin(1e-12));
    }
}

}  // namespace controlspace::surface_distance_test
