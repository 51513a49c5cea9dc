#include "io/surface/surface_mesh.h"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <string>

#include "controlspace/error.h"
#include "files/text_file.h"
#include "geometry/point_order.h"
#include "io/text/metric_rows.h"

namespace controlspace {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;

struct Soup {
    std::vector<Kernel::Point_3> points;
    std::vector<std::vector<std::size_t>> polygons;
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw InputError(fmt::format("{}: {}", path.string(), what));
}

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
    if (!read) fail(path, "no surface that can be read: is it cut off, or of another format?");
    if (soup.polygons.empty()) fail(path, "no polygons: nothing to read");
    for (std::size_t i = 0; i < soup.points.size(); ++i) {
        require_coordinates(point(soup, i), "vertex", i + 1, [&] { return path.string(); });
    }
    for (std::size_t i = 0; i < soup.polygons.size(); ++i) {
        for (const std::size_t corner : soup.polygons[i]) {
            if (corner < soup.points.size()) continue;
            fail(path, fmt::format("polygon {} has a corner that is none of the {} vertices", i + 1,
                                   soup.points.size()));
        }
    }
    return soup;
}

}  // namespace

SurfaceMesh read_surface_mesh(const std::filesystem::path& path) {
    const Soup soup = read_soup(path);
    SurfaceMesh mesh;
    for (const auto& polygon : soup.polygons) {
        for (const std::size_t corner : polygon) mesh.vertices.push_back(point(soup, corner));
    }
    std::sort(mesh.vertices.begin(), mesh.vertices.end(), precedes);
    mesh.vertices.erase(std::unique(mesh.vertices.begin(), mesh.vertices.end()),
                        mesh.vertices.end());
    const auto vertex = [&](std::size_t corner) {
        const auto place = std::lower_bound(mesh.vertices.begin(), mesh.vertices.end(),
                                            point(soup, corner), precedes);
        return static_cast<std::uint32_t>(place - mesh.vertices.begin());
    };
    std::vector<std::array<std::uint32_t, 2>> sides;  // both ways
    for (const auto& polygon : soup.polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const std::uint32_t a = vertex(polygon[i]);
            const std::uint32_t b = vertex(polygon[(i + 1) % polygon.size()]);
            if (a == b) continue;
            sides.push_back({a, b});
            sides.push_back({b, a});
        }
    }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    mesh.first.assign(mesh.vertices.size() + 1, 0);
    for (const auto& [a, b] : sides) {
        ++mesh.first[a + 1];
        mesh.neighbours.push_back(b);
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) mesh.first[i + 1] += mesh.first[i];
    return mesh;
}

}  // namespace controlspace
