// SPDX-License-Identifier: Apache-2.0
#include "io/surface/polygon_soup.h"

#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>

#include <cstdint>
#include <exception>
#include <sstream>
#include <string>
#include <string_view>

#include "controlspace/io/read_sources.h"
#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "io/text/scanner.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr std::size_t stl_head = 80, stl_triangle = 50;  // bytes

Point read_point(Scanner& file, const FilePart& vertex) {
    Point p;
    for (double& x : p) x = file.number<double>(vertex);
    return p;
}

/// A head of 80 bytes, the number of triangles, and 50 bytes for each: a normal, three vertices,
/// and two bytes of attributes.
PolygonSoup read_binary_stl(std::string_view bytes, const std::filesystem::path& path) {
    Scanner file(bytes, path);
    file.set_binary(true);
    if (bytes.size() < stl_head + sizeof(std::uint32_t)) {
        refuse_at(path, "no surface that can be read: is it cut off, or of another format?");
    }
    file.go_to(stl_head);
    const auto count = file.number<std::uint32_t>("the number of triangles");
    const std::size_t room = file.rest().size() / stl_triangle;
    if (count != room) {
        refuse_at(path,
                  "{} triangles by its head, but the file has bytes for {}: is it cut off, or of "
                  "another format?",
                  count, room);
    }
    PolygonSoup soup{.points = {}, .polygons = {}, .in_floats = true};
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t end = file.at() + stl_triangle;
        for (int k = 0; k < 3; ++k) file.number<float>("a normal");
        for (int k = 0; k < 3; ++k) {
            Point p;
            for (double& x : p) x = static_cast<double>(file.number<float>("a vertex"));
            soup.points.push_back(p);
        }
        soup.polygons.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        file.go_to(end);
    }
    return soup;
}

/// Keywords in any case, as Gmsh and others read them; normals are passed over.
PolygonSoup read_text_stl(std::string_view text, const std::filesystem::path& path) {
    Scanner file(text, path);
    PolygonSoup soup;
    std::vector<std::size_t> corners;
    bool in_solid = false;
    const auto expect = [&](std::string_view what) {
        const std::string_view word = file.word();
        if (lower_case(std::string(word)) == what) return;
        file.fail("'{}' expected, {} found", what,
                  word.empty() ? "the end of the file" : quote(word));
    };
    while (true) {
        const std::string_view word = file.word();
        const std::string keyword = lower_case(std::string(word));
        if (keyword.empty()) break;
        if (keyword == "solid" || keyword == "endsolid") {
            in_solid = keyword == "solid";
            file.line();  // its name
        } else if (keyword == "facet") {
            expect("normal");
            for (int k = 0; k < 3; ++k) file.word();
            expect("outer");
            expect("loop");
            corners.clear();
            while (true) {
                const std::string_view next = file.word();
                const std::string inside = lower_case(std::string(next));
                if (inside == "endloop") break;
                if (inside != "vertex") {
                    file.fail("'vertex' or 'endloop' expected, {} found",
                              next.empty() ? "the end of the file: is it cut off?" : quote(next));
                }
                corners.push_back(soup.points.size());
                soup.points.push_back(read_point(file, {"vertex", soup.points.size()}));
            }
            expect("endfacet");
            soup.polygons.push_back(corners);
        } else {
            file.fail("{} is not of a .stl: is it of another format?", quote(word));
        }
    }
    if (in_solid) refuse_at(path, "no 'endsolid' at its end: is it cut off?");
    return soup;
}

/// Binary by its size, whatever its first word is, which some programs write into the head.
PolygonSoup read_stl(std::string_view bytes, const std::filesystem::path& path) {
    std::string_view begin = bytes.substr(0, stl_head);
    if (begin.starts_with("\xEF\xBB\xBF")) begin.remove_prefix(3);
    begin.remove_prefix(std::min(begin.find_first_not_of(Scanner::blanks), begin.size()));
    const bool is_text = bytes.find('\0') == std::string_view::npos &&
                         lower_case(std::string(begin.substr(0, 5))) == "solid";
    return is_text ? read_text_stl(text_in(bytes, path), path) : read_binary_stl(bytes, path);
}

/// Points and faces; lines, points, normals and groups are passed over. A line ends in a backslash
/// where the next one continues it.
PolygonSoup read_obj(std::string_view text, const std::filesystem::path& path) {
    Scanner lines(text, path);
    PolygonSoup soup;
    while (!lines.rest().empty()) {
        std::string line(lines.line());
        const std::string where = lines.where();
        const auto trim = [&] { line.erase(line.find_last_not_of(Scanner::blanks) + 1); };
        for (trim(); line.ends_with('\\'); trim()) {
            line.back() = ' ';
            line += lines.line();
        }
        Scanner words(line, path, "#");
        const std::string_view keyword = words.word();
        if (keyword == "v") {
            Point& p = soup.points.emplace_back();
            for (double& x : p) {
                const std::string_view word = words.word();
                if (word.empty()) {
                    refuse_at(where, "vertex {} has fewer than three coordinates",
                              soup.points.size());
                }
                if (!parse_number(word, x)) {
                    refuse_at(where, "vertex {}: {} is not a number", soup.points.size(),
                              quote(word));
                }
            }
        } else if (keyword == "f") {
            auto& polygon = soup.polygons.emplace_back();
            for (auto word = words.word(); !word.empty(); word = words.word()) {
                long corner = 0;
                if (!parse_number(word.substr(0, word.find('/')), corner) || corner == 0) {
                    refuse_at(where, "a face with the corner {}: give the number of a vertex",
                              quote(word));
                }
                // From the first vertex, or backwards from the last one so far.
                polygon.push_back(corner > 0
                                      ? static_cast<std::size_t>(corner - 1)
                                      : soup.points.size() + static_cast<std::size_t>(corner));
            }
        }
    }
    return soup;
}

/// By CGAL.
PolygonSoup read_other(std::string_view bytes, const std::filesystem::path& path) {
    using Kernel = CGAL::Simple_cartesian<double>;
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    std::istringstream stream{std::string(bytes)};
    std::vector<Kernel::Point_3> points;
    PolygonSoup soup;
    bool read = false;
    try {
        read = lower_case_extension(path) == ".ply"
                   ? CGAL::IO::read_PLY(stream, points, soup.polygons)
                   : CGAL::IO::read_OFF(stream, points, soup.polygons);
    } catch (const std::exception&) {  // what it says is of CGAL's source
    }
    if (!read) refuse_at(path, "no surface that can be read: is it cut off, or of another format?");
    for (const Kernel::Point_3& p : points) soup.points.emplace_back(p.x(), p.y(), p.z());
    return soup;
}

}  // namespace

PolygonSoup read_polygon_soup(const std::filesystem::path& path) {
    const std::string ending = lower_case_extension(path);
    const std::string bytes = read_binary_file(path);
    PolygonSoup soup = ending == ".stl"   ? read_stl(bytes, path)
                       : ending == ".obj" ? read_obj(text_in(bytes, path), path)
                                          : read_other(bytes, path);
    if (soup.polygons.empty()) refuse_at(path, "no polygons: nothing to read");
    for (std::size_t i = 0; i < soup.points.size(); ++i) {
        require_coordinates(soup.points[i], "vertex", i + 1, [&] { return path.string(); });
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

}  // namespace controlspace
