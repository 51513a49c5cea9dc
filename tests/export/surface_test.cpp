// SPDX-License-Identifier: Apache-2.0
// Sources by curvature on surfaces whose curvature is known.
#include <catch2/catch.hpp>
#include <cmath>

#include "controlspace/io/read_surface_sources.h"
#include "export/surfaces.h"
#include "io/surface/surface_mesh.h"
#include "sources/files.h"

namespace controlspace::surface_test {

using Catch::Matchers::Contains;

namespace {

std::string obj_text(const Surface& s) {
    std::string text;
    for (const Point& p : s.vertices) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (const auto& t : s.triangles) {
        text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    return text;
}
std::string ply_text(const Surface& s) {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
        "property double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        s.vertices.size(), s.triangles.size());
    for (const Point& p : s.vertices) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    for (const auto& t : s.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    return text;
}
std::string stl_text(const Surface& s) {
    std::string text = "solid s\n";
    for (const auto& t : s.triangles) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const std::size_t i : t) {
            const Point& p = s.vertices[i];
            text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid s\n";
}
std::string stl_bytes(const Surface& s) {
    std::string bytes(80, ' ');
    const auto append = [&](const auto& x) {
        bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
    };
    append(static_cast<std::uint32_t>(s.triangles.size()));
    for (const auto& t : s.triangles) {
        for (int i = 0; i < 3; ++i) append(0.0F);
        for (const std::size_t i : t) {
            for (const double x : s.vertices[i]) append(static_cast<float>(x));
        }
        append(std::uint16_t{0});
    }
    return bytes;
}

/// Length that a metric asks for along `direction`.
double length_along(const Metric& m, const Vector& direction) {
    return 1 / metric_length(m, direction.normalized());
}

}  // namespace

TEST_CASE("lengths on a torus follow both curvatures, in all formats") {
    const ScratchDirectory scratch;
    const auto [name, text] = GENERATE(table<std::string, std::string (*)(const Surface&)>({
        {"t.off", off_text},
        {"t.obj", obj_text},
        {"t.ply", ply_text},
        {"t.stl", stl_text},
        {"b.stl", stl_bytes},
    }));
    CAPTURE(name);
    const Surface surface = torus(48);
    const auto sources = read_surface_sources(scratch.file(name, text(surface)),
                                              {.angle = 20, .h_min = 1e-3, .h_max = 100})
                             .sources;
    REQUIRE(sources.size() == surface.vertices.size());
    for (const auto& [p, metric, own_growth] : sources) {
        const double r = std::hypot(p.x(), p.y());
        const Vector e_r(p.x() / r, p.y() / r, 0), around(-p.y() / r, p.x() / r, 0);
        const Vector normal = (r - 3) * e_r + p.z() * Vector::UnitZ();
        const double cosine = r - 3;     // of the angle v
        const double small = chord(20);  // circle of radius 1
        CHECK(length_along(metric, normal.cross(around)) == Approx(small).epsilon(0.03));
        if (std::abs(cosine) > 0.2) {
            const double large = std::min(100.0, chord(20) * r / std::abs(cosine));
            CHECK(length_along(metric, around) == Approx(large).epsilon(0.03));
        }
        CHECK(length_along(metric, normal) == Approx(small).epsilon(0.03));
    }
}

TEST_CASE("bounds hold where the curvature asks for more or less") {
    const ScratchDirectory scratch;
    // A cylinder of radius 1: flat along z.
    const Surface cylinder = cone(1, 1, 4, 40, 20);
    const auto path = scratch.file("c.off", off_text(cylinder));
    for (const auto& [p, metric, own_growth] :
         read_surface_sources(path, {.h_min = 0.01, .h_max = 0.5}).sources) {
        CHECK(length_along(metric, Vector::UnitZ()) == Approx(0.5));
        CHECK(length_along(metric, {-p.y(), p.x(), 0}) == Approx(chord(15)).epsilon(0.04));
    }
    for (const PointSource& s : read_surface_sources(path, {.h_min = 0.4, .h_max = 0.5}).sources) {
        CHECK(eigen_frame(s.metric).lengths[0] == Approx(0.4));
    }
    // Left out: 0.1 of the diagonal.
    const double diagonal = std::sqrt(4 + 4 + 16);
    CHECK(length_along(read_surface_sources(path).sources.front().metric, Vector::UnitZ()) ==
          Approx(0.1 * diagonal));
    const auto error = [&](const CurvatureSizes& sizes) {
        return error_of([&] { read_surface_sources(path, sizes); });
    };
    CHECK_THAT(error({.h_min = 1, .h_max = 0.5}), Contains("lengths from 1 to 0.5"));
    CHECK_THAT(error({.angle = 200}), Contains("an angle of 200"));
    CHECK_THAT(error({.crease = 0}), Contains("a crease angle of 0: give one above 0, up to 180"));
    CHECK_THAT(error({.elements_across = 0}),
               Contains("0 elements across walls and gaps: give a positive number"));
}

TEST_CASE("triangles of their own corners are joined where they touch") {
    const ScratchDirectory scratch;
    const Surface square = patch({2, 2}, [](double u, double v) { return Point(u, v, 0); });
    const SurfaceMesh mesh = read_surface_mesh(scratch.file("s.stl", stl_text(square)));
    REQUIRE(mesh.vertices.size() == 9);
    // In ascending order of x: the fifth is the middle.
    CHECK(mesh.vertices[4] == Point(0.5, 0.5, 0));
    CHECK(std::ranges::count_if(mesh.triangles,
                                [](const auto& t) { return std::ranges::count(t, 4U) == 1; }) == 6);
}

TEST_CASE("corners that differ by round-off are one vertex") {
    const ScratchDirectory scratch;
    // In a text, by the round-off of doubles; in bytes, by neighbouring floats, also far away.
    const bool binary = GENERATE(false, true);
    const double far = GENERATE(0., 100.);
    CAPTURE(binary, far);
    const Surface whole = transformed(cone(1, 1, 4, 24, 8),
                                      Eigen::Affine3d(Eigen::Translation3d(far, -far, 2 * far)));
    Surface torn;
    RandomFractions random(1);
    for (const auto& t : whole.triangles) {
        for (const std::size_t i : t) {
            Point p = whole.vertices[i];
            for (double& x : p) {
                const float nearby = std::nextafter(static_cast<float>(x), 1e9F);
                x = !binary          ? x + 1e-15 * (random() - 0.5)
                    : random() < 0.5 ? static_cast<double>(static_cast<float>(x))
                                     : static_cast<double>(nearby);
            }
            torn.vertices.push_back(p);
        }
        const std::size_t n = torn.vertices.size();
        torn.triangles.push_back({n - 3, n - 2, n - 1});
    }
    const auto path = scratch.file("c.stl", binary ? stl_bytes(torn) : stl_text(torn));
    const SurfaceMesh mesh = read_surface_mesh(path);
    CHECK(mesh.vertices.size() == whole.vertices.size());
    CHECK(mesh.triangles.size() == whole.triangles.size());
    const SurfaceEdges edges = surface_edges(mesh);
    CHECK(edges.count == 24 * 9 + 24 * 8 * 2);
    CHECK(edges.open.size() == 2 * 24);  // the circles at both ends
    for (const auto& [p, metric, own_growth] : read_surface_sources(path).sources) {
        if (std::abs(p.z() - 2 * far - 2) > 1.6) continue;
        CHECK(eigen_frame(metric).lengths[0] == Approx(chord(15)).epsilon(0.03));
    }
}

TEST_CASE("vertices that are apart stay apart, however small the triangles") {
    const ScratchDirectory scratch;
    // Two tetrahedra 1e-7 of the box apart.
    std::string text;
    for (const double x : {0., 1e-7}) {
        text += fmt::format("v {} 0 0\nv {} 1 0\nv {} 0 1\nv {} 0 0\n", x, x, x, x == 0 ? -1. : 1.);
    }
    text += "f 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 5 6 7\nf 5 6 8\nf 6 7 8\nf 7 5 8\n";
    const SurfaceMesh mesh = read_surface_mesh(scratch.file("t.obj", text));
    CHECK(mesh.vertices.size() == 8);
    CHECK(surface_edges(mesh).open.empty());
}

TEST_CASE("a .stl is read as programs write it: a mark, capitals, several solids") {
    const ScratchDirectory scratch;
    const Surface square = patch({2, 2}, [](double u, double v) { return Point(u, v, 0); });
    const std::string text = stl_text(square);
    std::string capitals = text;
    for (char& c : capitals) c = static_cast<char>(std::toupper(c));
    const std::string other = stl_text(transformed(square, somewhere(1)));
    std::string head = stl_bytes(square);
    head.replace(0, 5, "solid");
    const auto [bytes, triangles] = GENERATE_COPY(table<std::string, std::size_t>({
        {"\xEF\xBB\xBF" + text, 8},
        {"\n \r\n" + text, 8},
        {capitals, 8},
        {text + other, 16},
        {text + "\n" + other + text, 16},
        {head, 8},
        {stl_bytes(square) + "\n", 8},
        {"solid\nfacet normal nan nan nan outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1e+0 0\n"
         "endloop endfacet endsolid",
         1},
    }));
    CAPTURE(bytes);
    CHECK(read_surface_mesh(scratch.file("s.stl", bytes)).triangles.size() == triangles);
}

TEST_CASE("a .stl that is cut off or of another size is refused, by its place") {
    const ScratchDirectory scratch;
    const Surface square = patch({2, 2}, [](double u, double v) { return Point(u, v, 0); });
    const std::string text = stl_text(square), bytes = stl_bytes(square);
    std::string fewer = bytes;
    fewer[80] = 5;
    std::string typo = text;
    typo.replace(typo.find("vertex 0 "), 9, "vertex O ");
    const auto [wrong, expected] = GENERATE_COPY(table<std::string, std::string>({
        {bytes.substr(0, bytes.size() - 1), "s.stl: 8 triangles by its head, but the file has"},
        {fewer, "s.stl: 5 triangles by its head, but the file has bytes for 8: is it cut off"},
        {bytes.substr(0, 82), "s.stl: no surface that can be read"},
        {text.substr(0, text.find("endsolid")), "s.stl: no 'endsolid' at its end: is it cut off?"},
        {text.substr(0, text.rfind("endloop")), ":56: 'vertex' or 'endloop' expected, the end"},
        {typo, "s.stl:4: vertex 1: 'O' is not a number"},
        {"solid\nfaset normal", "s.stl:2: 'faset' is not of a .stl"},
    }));
    const std::string error =
        error_of([&, &bad = wrong] { read_surface_mesh(scratch.file("s.stl", bad)); });
    CHECK_THAT(error, Contains(expected));
}

TEST_CASE("a .obj is read whatever stands beside its faces") {
    const ScratchDirectory scratch;
    const std::string points = "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 # the third\nv 0 1 0\n";
    const auto [text, triangles] = GENERATE_COPY(table<std::string, std::size_t>({
        {"\xEF\xBB\xBF" + points + "f 1 2 3 4\n", 2},
        {points + "l 1 2\nl 2 3 4\np 1\nf 1 2 3\n", 1},
        {points + "f 1 2 \\\n 3 \\\r\n4\r\n", 2},
        {"mtllib a.mtl\no a\n" + points + "vt 0 0\nvn 0 0 1\ng x y\ns off\nf 1/1/1 2//1 3/1\n", 1},
        {points + "f -4 -3 -2\nv 0 0 1\nf -5 -4 -1", 2},
    }));
    CAPTURE(text);
    CHECK(read_surface_mesh(scratch.file("s.obj", text)).triangles.size() == triangles);
    const auto error = [&](const std::string& more) {
        return error_of([&] { read_surface_mesh(scratch.file("e.obj", points + more)); });
    };
    CHECK_THAT(error("v 1 x 0\nf 1 2 3\n"), Contains("e.obj:5: vertex 5: 'x' is not a number"));
    CHECK_THAT(error("f 1 2 0\n"), Contains("e.obj:5: a face with the corner '0'"));
    CHECK_THAT(error("f 1 2 -5\n"),
               Contains("e.obj: polygon 1 has a corner that is none of the 4"));
}

TEST_CASE("a byte order mark is passed over in all texts of surfaces") {
    const ScratchDirectory scratch;
    const auto [name, text] = GENERATE(table<std::string, std::string (*)(const Surface&)>(
        {{"t.off", off_text}, {"t.obj", obj_text}, {"t.ply", ply_text}, {"t.stl", stl_text}}));
    CAPTURE(name);
    const Surface surface = torus(6);
    CHECK(read_surface_mesh(scratch.file(name, "\xEF\xBB\xBF" + text(surface))).triangles.size() ==
          surface.triangles.size());
}

TEST_CASE("copies of a triangle and triangles without an area are left out") {
    const ScratchDirectory scratch;
    const auto path = scratch.file("t.obj",
                                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\n"
                                   "f 1 2 3\nf 3 2 1\nf 1 2 4\nf 1 4 5\nf 2 2 3\n");
    CHECK(read_surface_mesh(path).triangles.size() == 1);
    const SurfaceSources read = read_surface_sources(path, {.h_max = 2});
    CHECK(read.sources.size() == 3);
    CHECK(read.skipped == 2);
}

TEST_CASE("surfaces without triangles are refused") {
    const ScratchDirectory scratch;
    const auto error = [&](const std::string& name, const std::string& text) {
        return error_of([&] { read_surface_sources(scratch.file(name, text)); });
    };
    CHECK_THAT(error("t.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
               Contains("t.obj: no triangle has an area"));
    CHECK_THAT(error("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), Contains("t.obj: "));
    CHECK_THAT(error("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), Contains("t.obj: no "));
}

}  // namespace controlspace::surface_test
