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
