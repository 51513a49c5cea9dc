// SPDX-License-Identifier: Apache-2.0
#include "io/surface/surface_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "geometry/extent_of.h"
#include "geometry/hash_of_words.h"
#include "geometry/point_order.h"
#include "io/surface/polygon_soup.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// The vertices of all polygons, each place once and in ascending order.
std::vector<Point> places_of(const PolygonSoup& soup) {
    std::vector<Point> places;
    for (const auto& polygon : soup.polygons) {
        for (const std::size_t corner : polygon) places.push_back(soup.points[corner]);
    }
    std::sort(places.begin(), places.end(), precedes);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

/// For each place the first one that is within a tolerance along each axis, or itself: programs
/// that compute the corners of each triangle anew write them with different round-off.
std::vector<std::uint32_t> first_within(double tolerance, const std::vector<Point>& places) {
    // So large that most places are within the tolerance of no other cell.
    const double cell = 64 * tolerance;
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& c) const { return hash_of_words(c); }
    };
    std::unordered_multimap<Cell, std::uint32_t, Hash> kept;
    const auto number = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell)); };
    std::vector<std::uint32_t> first(places.size());
    std::iota(first.begin(), first.end(), 0);
    if (!(cell > 0)) return first;  // a single place
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const Point from = places[i] - places.front();
        Cell low, high, at;
        for (std::size_t k = 0; k < 3; ++k) {
            const double place = from[static_cast<Axis>(k)];
            low[k] = number(place - tolerance);
            high[k] = number(place + tolerance);
            at[k] = number(place);
        }
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                for (std::int64_t z = low[2]; z <= high[2]; ++z) {
                    const auto [begin, end] = kept.equal_range({x, y, z});
                    for (auto other = begin; other != end; ++other) {
                        const double apart =
                            (places[other->second] - places[i]).lpNorm<Eigen::Infinity>();
                        if (apart <= tolerance) first[i] = std::min(first[i], other->second);
                    }
                }
            }
        }
        if (first[i] == i) kept.emplace(at, i);
    }
    return first;
}

/// Shortest height of a triangle.
double height(const Point& a, const Point& b, const Point& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

/// By how much round-off moves a coordinate: that of the file's numbers, or of computing them.
double round_off(const PolygonSoup& soup, double diagonal) {
    double largest = 0;
    for (const Point& p : soup.points) largest = std::max(largest, p.lpNorm<Eigen::Infinity>());
    return soup.in_floats ? 0x1p-23 * largest : 1e-9 * diagonal;
}

/// Leaves out later triangles with the vertices of an earlier one.
void remove_copies(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::set<std::array<std::uint32_t, 3>> seen;
    std::erase_if(triangles, [&](std::array<std::uint32_t, 3> triangle) {
        std::ranges::sort(triangle);
        return !seen.insert(triangle).second;
    });
}

}  // namespace

SurfaceMesh read_surface_mesh(const std::filesystem::path& path) {
    const PolygonSoup soup = read_polygon_soup(path);
    const std::vector<Point> places = places_of(soup);
    if (places.empty()) refuse_at(path, "polygons without corners: nothing to read");
    SurfaceMesh mesh;
    mesh.diagonal = extent_of(places).edges().norm();
    const std::vector<std::uint32_t> first = first_within(round_off(soup, mesh.diagonal), places);
    std::vector<std::uint32_t> number(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (first[i] == i) {
            number[i] = static_cast<std::uint32_t>(mesh.vertices.size());
            mesh.vertices.push_back(places[i]);
        } else {
            number[i] = number[first[i]];
        }
    }
    const auto vertex = [&](std::size_t corner) {
        const auto place =
            std::lower_bound(places.begin(), places.end(), soup.points[corner], precedes);
        return number[static_cast<std::size_t>(place - places.begin())];
    };
    for (const auto& polygon : soup.polygons) {
        for (std::size_t i = 2; i < polygon.size(); ++i) {
            const std::uint32_t a = vertex(polygon[0]), b = vertex(polygon[i - 1]),
                                c = vertex(polygon[i]);
            if (height(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) <= rounding(mesh)) {
                continue;
            }
            mesh.triangles.push_back({a, b, c});
        }
    }
    if (mesh.triangles.empty()) refuse_at(path, "no triangle has an area: nothing to read");
    remove_copies(mesh.triangles);
    return mesh;
}

SurfaceEdges surface_edges(const SurfaceMesh& mesh) {
    std::vector<std::array<std::uint32_t, 2>> sides;
    for (const auto& [a, b, c] : mesh.triangles) {
        for (const auto& [p, q] : {std::pair(a, b), {b, c}, {c, a}}) {
            sides.push_back({std::min(p, q), std::max(p, q)});
        }
    }
    std::sort(sides.begin(), sides.end());
    SurfaceEdges edges;
    for (auto side = sides.begin(); side != sides.end(); ++edges.count) {
        const auto end = std::find_if(side, sides.end(), [&](const auto& s) { return s != *side; });
        if ((end - side) % 2 != 0) edges.open.push_back(*side);
        side = end;
    }
    return edges;
}

}  // namespace controlspace
