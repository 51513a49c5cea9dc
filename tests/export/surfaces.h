// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "controlspace/geometry/point.h"
#include "geometry/random_fractions.h"

namespace controlspace {

inline constexpr double pi = std::numbers::pi;

/// A surface of triangles for tests.
struct Surface {
    std::vector<Point> vertices;
    std::vector<std::array<std::size_t, 3>> triangles;

    Surface& operator+=(const Surface& other) {
        for (const auto& [a, b, c] : other.triangles) {
            const std::size_t n = vertices.size();
            triangles.push_back({a + n, b + n, c + n});
        }
        vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
        return *this;
    }
};

inline Surface transformed(Surface s, const Eigen::Affine3d& map) {
    for (Point& p : s.vertices) p = map * p;
    return s;
}

/// How the parameters of a patch are divided.
struct Division {
    std::size_t n, m;
    bool closed_u = false, closed_v = false;
    /// Vertices moved by up to this part of a cell, diagonals either way; rims are kept.
    double jitter = 0;
};

/// A patch of n x m quadrangles, each cut in two, over (u, v) in [0, 1]^2.
inline Surface patch(const Division& d, const std::function<Point(double, double)>& at) {
    Surface s;
    RandomFractions random(1);
    const std::size_t columns = d.closed_u ? d.n : d.n + 1, rows = d.closed_v ? d.m : d.m + 1;
    const auto moved = [&](std::size_t i, std::size_t n, bool closed) {
        const bool rim = !closed && (i == 0 || i == n);
        return (double(i) + (rim ? 0 : d.jitter * (2 * random() - 1))) / double(n);
    };
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i < columns; ++i) {
            const double u = moved(i, d.n, d.closed_u), v = moved(j, d.m, d.closed_v);
            s.vertices.push_back(at(u, v));
        }
    }
    const auto index = [&](std::size_t i, std::size_t j) {
        return (j % rows) * columns + i % columns;
    };
    for (std::size_t j = 0; j < d.m; ++j) {
        for (std::size_t i = 0; i < d.n; ++i) {
            const std::size_t a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1),
                              e = index(i, j + 1);
            if (d.jitter > 0 && random() < 0.5) {
                s.triangles.push_back({a, b, e});
                s.triangles.push_back({b, c, e});
            } else {
                s.triangles.push_back({a, b, c});
                s.triangles.push_back({a, c, e});
            }
        }
    }
    return s;
}

/// The torus of radii 3 and 1 around the z axis.
inline Surface torus(std::size_t n, double jitter = 0) {
    return patch({2 * n, n, true, true, jitter}, [](double u, double v) {
        const double r = 3 + std::cos(2 * pi * v);
        return Point(r * std::cos(2 * pi * u), r * std::sin(2 * pi * u), std::sin(2 * pi * v));
    });
}

/// Around the z axis, of radius a at z = 0 and b at z = height; of strips alone for m = 1.
inline Surface cone(double a, double b, double height, std::size_t n, std::size_t m,
                    double jitter = 0) {
    return patch({n, m, true, false, jitter}, [=](double u, double v) {
        const double r = (1 - v) * a + v * b;
        return Point(r * std::cos(2 * pi * u), r * std::sin(2 * pi * u), v * height);
    });
}

/// The unit sphere between two circles of latitude; with m = n / 2 - 2 nearly square cells.
inline Surface sphere(std::size_t n, std::size_t m, double jitter = 0) {
    return patch({n, m, true, false, jitter}, [](double u, double v) {
        const double t = pi * (0.1 + 0.8 * v);
        return Point(std::sin(t) * std::cos(2 * pi * u), std::sin(t) * std::sin(2 * pi * u),
                     std::cos(t));
    });
}

/// The faces of a box, each n x n.
inline Surface box(const Point& low, const Point& high, std::size_t n) {
    Surface s;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {0, 1}) {
            s += patch({n, n}, [&](double u, double v) {
                Vector x;
                x[axis] = side;
                x[(axis + 1) % 3] = u;
                x[(axis + 2) % 3] = v;
                return Point(low + x.cwiseProduct(high - low));
            });
        }
    }
    return s;
}

inline std::string off_text(const Surface& s) {
    std::string text =
        fmt::format("OFF\n# a comment\n{} {} 0\n", s.vertices.size(), s.triangles.size());
    for (const Point& p : s.vertices) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    for (const auto& t : s.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    return text;
}

inline double chord(double degrees) { return 2 * std::sin(degrees / 2 * pi / 180); }

/// Rotated, scaled and moved.
inline Eigen::Affine3d somewhere(double scale) {
    return Eigen::Translation3d(0.3, -2, 1) *
           Eigen::AngleAxisd(0.7, Vector(1, 2, -1).normalized()) * Eigen::Scaling(scale);
}

}  // namespace controlspace
