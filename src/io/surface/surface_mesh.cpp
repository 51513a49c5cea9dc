#include "io/surface/surface_mesh.h"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <exception>
#include <set>
#include <utility>

#include "files/text_file.h"
#include "geometry/extent_of.h"
#include "geometry/point_order.h"
#include "io/text/metric_rows.h"
#include "refuse.h"

namespace controlspace {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;

struct Soup {
    std::vector<Kernel::Point_3> points;
    std::vector<std::vector<std::size_t>> polygons;
};

Point point(const Soup& soup, std::size_t i) {
    const Kernel::Point_3& p = soup.points[i];
    return {p.x(), p.y(), p.z()};
}

Soup read_soup(const std::filesystem::path& path) {
    read_binary_file(path);  // throws for what is missing, empty or a directory
    Soup soup;
    bool read = false;
    try {
        read = CGAL::IO::read_polygon_soup(path.string(), soup.points, soup.polygons,
                                           CGAL::parameters::verbose(false));
    } catch (const std::exception&) {  // what it says is of CGAL's source
    }
    if (!read) refuse_at(path, "no surface that can be read: is it cut off, or of another format?");
    if (soup.polygons.empty()) refuse_at(path, "no polygons: nothing to read");
    for (std::size_t i = 0; i < soup.points.size(); ++i) {
        require_coordinates(point(soup, i), "vertex", i + 1, [&] { return path.string(); });
    }
    for (std::size_t i = 0; i < soup.polygons.size(); ++i) {
        for (const std::size_t corner : soup.polygons[i]) {
            if (corner < soup.points.size()) continue;
            refuse_at(path, "polygon {} has a corner that is none of the {} vertices", i + 1,
                      soup.points.size());
        }
    }
    return soup;
}

/// The vertices of all polygons, each place once and in ascending order.
std::vector<Point> places_of(const Soup& soup) {
    std::vector<Point> places;
    for (const auto& polygon : soup.polygons) {
        for (const std::size_t corner : polygon) places.push_back(point(soup, corner));
    }
    std::sort(places.begin(), places.end(), precedes);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

/// Shortest height of a triangle.
double height(const Point& a, const Point& b, const Point& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
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
    const Soup soup = read_soup(path);
    SurfaceMesh mesh{.vertices = places_of(soup), .triangles = {}};
    if (mesh.vertices.empty()) refuse_at(path, "polygons without corners: nothing to read");
    mesh.diagonal = extent_of(mesh.vertices).edges().norm();
    const auto vertex = [&](std::size_t corner) {
        const auto place = std::lower_bound(mesh.vertices.begin(), mesh.vertices.end(),
                                            point(soup, corner), precedes);
        return static_cast<std::uint32_t>(place - mesh.vertices.begin());
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

}  // namespace controlspace
