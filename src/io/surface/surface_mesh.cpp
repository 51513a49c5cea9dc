#include "io/surface/surface_mesh.h"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/sources/point_source.h"
#include "geometry/point_order.h"
#include "io/text/text_file.h"

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

/// CGAL allocates as much as the head of a file says it holds: what it says is checked first. The
/// counts are those of the words behind "element NAME" (.ply) or the first three numbers (.off).
void require_plausible_counts(const std::filesystem::path& path) {
    const std::string bytes = read_binary_file(path);
    const std::string_view file(bytes);
    const std::string ending = lower_case_extension(path);
    constexpr std::string_view blanks = " \t\r\n";
    const auto require = [&](std::size_t at) {
        at = std::min(file.find_first_not_of(blanks, at), file.size());
        const std::string_view word =
            file.substr(at, std::min(file.find_first_of(blanks, at), file.size()) - at);
        std::size_t count = 0;
        if (parse_number(word, count) && count <= file.size()) return at + word.size();
        const auto line = 1 + std::count(bytes.begin(), bytes.begin() + std::ptrdiff_t(at), '\n');
        throw InputError(fmt::format("{}: a count of {}, but {} bytes cannot hold so many",
                                     place(path, std::size_t(line)), quote(word), file.size()));
    };
    if (ending == ".ply") {
        const std::size_t end = std::min(file.find("end_header"), file.size());
        constexpr std::string_view element = "\nelement ";
        for (std::size_t at = file.find(element); at < end; at = file.find(element, at + 1)) {
            require(file.find(' ', at + element.size()));
        }
    } else if (ending == ".off") {
        std::size_t at = file.find("OFF");
        if (at == std::string_view::npos) fail(path, "does not start with OFF");
        at += 3;
        const auto skip_comments = [&] {
            at = std::min(file.find_first_not_of(blanks, at), file.size());
            while (at < file.size() && file[at] == '#') {
                at = file.find_first_not_of(blanks, std::min(file.find('\n', at), file.size()));
                at = std::min(at, file.size());
            }
        };
        for (int i = 0; i < 3; ++i) {
            skip_comments();
            at = require(at);
        }
    }
}

Soup read_soup(const std::filesystem::path& path) {
    require_plausible_counts(path);
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
        for (Axis a = 0; a < 3; ++a) {
            const double x = soup.points[i][a];
            if (!is_coordinate(x)) {
                fail(path, fmt::format("vertex {} has a coordinate {}", i + 1, x));
            }
        }
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
    const auto point = [&](std::size_t i) {
        const Kernel::Point_3& p = soup.points[i];
        return Point(p.x(), p.y(), p.z());
    };
    for (const auto& polygon : soup.polygons) {
        for (const std::size_t corner : polygon) mesh.vertices.push_back(point(corner));
    }
    std::sort(mesh.vertices.begin(), mesh.vertices.end(), precedes);
    mesh.vertices.erase(std::unique(mesh.vertices.begin(), mesh.vertices.end()),
                        mesh.vertices.end());
    const auto vertex = [&](std::size_t corner) {
        const auto place =
            std::lower_bound(mesh.vertices.begin(), mesh.vertices.end(), point(corner), precedes);
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
