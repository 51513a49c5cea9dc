// SPDX-License-Identifier: Apache-2.0
// Files that other libraries read: damaged ones may bring these down.
#include <fmt/format.h>
#include <sys/resource.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <iostream>
#include <sstream>

#include "cli/sandbox.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/read_vtk_sources.h"
#include "controlspace/io/require_readable.h"
#include "damaged_copies.h"
#include "gmsh/cad_surface.h"
#include "io/surface/surface_mesh.h"
#include "sources/files.h"
#ifdef CONTROLSPACE_GMSH
#include <gmsh.h>
#endif

namespace controlspace::damaged_files_test {
namespace {

/// A patch of a paraboloid, 7 x 7 vertices: enough for its curvature.
constexpr int side = 7;

std::array<float, 3> vertex(int i) {
    const float x = static_cast<float>(i % side), y = static_cast<float>(i / side);
    return {x, y, 0.0625F * (x * x + y * y)};
}

/// visit(a, b, c) for its triangles.
template <class Visit>
void for_each_triangle(Visit&& visit) {
    for (int j = 0; j + 1 < side; ++j) {
        for (int i = 0; i + 1 < side; ++i) {
            const int a = j * side + i;
            visit(a, a + 1, a + side);
            visit(a + 1, a + side + 1, a + side);
        }
    }
}

std::string off_text() {
    std::ostringstream text;
    text << "OFF\n49 72 0\n";
    for (int i = 0; i < side * side; ++i) {
        for (const float x : vertex(i)) text << x << ' ';
        text << '\n';
    }
    for_each_triangle(
        [&](int a, int b, int c) { text << "3 " << a << ' ' << b << ' ' << c << '\n'; });
    return text.str();
}

std::string ply_text() {
    const std::string off = off_text();
    return "ply\nformat ascii 1.0\nelement vertex 49\nproperty double x\nproperty double y\n"
           "property double z\nelement face 72\nproperty list uchar int vertex_indices\n"
           "end_header\n" +
           off.substr(off.find("72 0\n") + 5);
}

std::string obj_text() {
    std::ostringstream text;
    for (int i = 0; i < side * side; ++i) {
        text << 'v';
        for (const float x : vertex(i)) text << ' ' << x;
        text << '\n';
    }
    for_each_triangle([&](int a, int b, int c) {
        text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
    });
    return text.str();
}

std::string stl_text() {
    std::ostringstream text;
    text << "solid s\n";
    for_each_triangle([&](int a, int b, int c) {
        text << "facet normal 0 0 0\nouter loop\n";
        for (const int corner : {a, b, c}) {
            text << "vertex";
            for (const float x : vertex(corner)) text << ' ' << x;
            text << '\n';
        }
        text << "endloop\nendfacet\n";
    });
    return text.str() + "endsolid s\n";
}

template <class Number>
void append(std::string& bytes, Number number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string stl_bytes() {
    std::string bytes(80, ' ');
    append(bytes, std::uint32_t{72});
    for_each_triangle([&](int a, int b, int c) {
        for (int i = 0; i < 3; ++i) append(bytes, 0.0F);
        for (const int corner : {a, b, c}) {
            for (const float x : vertex(corner)) append(bytes, x);
        }
        append(bytes, std::uint16_t{0});
    });
    return bytes;
}

std::string ply_bytes() {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 49\nproperty float x\n"
        "property float y\nproperty float z\nelement face 72\n"
        "property list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < side * side; ++i) {
        for (const float x : vertex(i)) append(bytes, x);
    }
    for_each_triangle([&](std::int32_t a, std::int32_t b, std::int32_t c) {
        append(bytes, std::uint8_t{3});
        for (const std::int32_t corner : {a, b, c}) append(bytes, corner);
    });
    return bytes;
}

const std::string vtp =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
    "byte_order=\"LittleEndian\">\n<PolyData><Piece NumberOfPoints=\"2\" NumberOfVerts=\"0\" "
    "NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData><DataArray "
    "type=\"Float64\" Name=\"a:metric\" NumberOfComponents=\"1\" format=\"ascii\">0.5 0.25"
    "</DataArray></PointData>\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
    "format=\"ascii\">\n0 0 0 1 0 0</DataArray></Points>\n</Piece></PolyData></VTKFile>\n";

/// Reads damaged copies of a file as require_readable.h tells programs to: each is answered, or
/// refused by an InputError of one line, which names the file.
template <class Read>
void check_damaged(const fs::path& file, const Read& read) {
    // Some are read until the time is over: a second, in place of the twenty of require_readable.
    const auto read_soon = [&] {
        const rlimit second{1, 1};
        ::setrlimit(RLIMIT_CPU, &second);
        read(file);
    };
    const auto read_guarded = [&] {
        require_readable(file, read_soon);
        read(file);
    };
    const std::string bytes = file_text(file);
    REQUIRE(error_of(read_guarded) == "");
    int copy = 0, refused = 0;
    const int all = for_each_damaged_copy(bytes, 20, [&](const std::string& damaged) {
        CAPTURE(file.filename(), copy++);
        std::ofstream(file, std::ios::binary) << damaged;
        const std::string error = error_of(read_guarded);
        if (error.empty()) return;
        ++refused;
        CHECK_THAT(error, Catch::Matchers::Contains(file.string()));
    });
    // Seen with --verbose of ctest.
    std::cout << file.filename().string() << ": " << all << " damaged copies, " << all - refused
              << " read, " << refused << " refused" << std::endl;
}

/// What the program makes of four sources.
fs::path made(const Sandbox& box, const std::string& arguments, const std::string& name) {
    box.write("s.csv", "x,y,z,h\n0,0,0,0.3\n1,0,0,0.3\n0,1,0,0.3\n1,1,1,0.4\n");
    REQUIRE(box.run(arguments + name).status == 0);
    return box / name;
}

#if defined(CONTROLSPACE_GMSH) && defined(CONTROLSPACE_CGAL)
/// One bilinear B-spline surface, as sections of records of 80 characters.
std::string igs_text() {
    std::string text;
    const auto section = [&](char letter, std::size_t width, const std::string& content,
                             const std::string& owner = "") {
        const std::size_t records = (content.size() + width - 1) / width;
        for (std::size_t i = 0; i < records; ++i) {
            std::string record = content.substr(i * width, width);
            record.resize(width, ' ');
            text += fmt::format("{}{}{}{:7}\n", record, owner, letter, i + 1);
        }
        return records;
    };
    const std::string surface =
        "128,1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,0.,0.,0.,1.,0.,1.,"
        "1.,1.,0.,1.,0.,1.;";
    constexpr std::size_t parameters = 64;
    const std::size_t lines = (surface.size() + parameters - 1) / parameters;
    const std::size_t s = section('S', 72, "a surface");
    const std::size_t g = section(
        'G', 72,
        "1H,,1H;,1Hd,5Hd.igs,1Hd,1Hd,32,38,6,308,15,1Hd,1.,6,1HM,1,0.01,15H20260101.000000,1.E-7,"
        "2.,1Hd,1Hd,11,0,;");
    const std::string numbers =
        fmt::format("{:8}{:8}{:8}{:8}{:8}{:8}{:8}{:8}{:08}", 128, 1, 0, 0, 0, 0, 0, 0, 0) +
        fmt::format("{:8}{:8}{:8}{:8}{:8}", 128, 0, 0, lines, 0);
    const std::size_t d = section('D', 72, numbers);
    const std::size_t p = section('P', parameters, surface, fmt::format("{:8}", 1));
    section('T', 72, fmt::format("S{:7}G{:7}D{:7}P{:7}", s, g, d, p));
    return text;
}

/// A rectangle, as Gmsh writes it.
void write_cad(const fs::path& file) {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::model::occ::addRectangle(0, 0, 0, 1, 2);
    gmsh::model::occ::synchronize();
    gmsh::write(file.string());
    gmsh::finalize();
}
#endif

}  // namespace

#ifdef CONTROLSPACE_CGAL
TEST_CASE("damaged files of surfaces are read or refused") {
    const auto [name, bytes] = GENERATE(table<std::string, std::string>({{"d.off", off_text()},
                                                                         {"d.ply", ply_text()},
                                                                         {"b.ply", ply_bytes()},
                                                                         {"d.obj", obj_text()},
                                                                         {"d.stl", stl_text()},
                                                                         {"b.stl", stl_bytes()}}));
    const Sandbox box("damaged-surfaces");
    box.write(name, bytes);
    check_damaged(box / name, read_surface_mesh);
}
#endif

#if defined(CONTROLSPACE_GMSH) && defined(CONTROLSPACE_CGAL)
TEST_CASE("damaged files of CAD are read or refused") {
    const Sandbox box("damaged-cad");
    const std::string name = GENERATE("d.step", "d.igs");
    name == "d.igs" ? box.write(name, igs_text()) : write_cad(box / name);
    check_damaged(box / name, read_cad_surface);
}

TEST_CASE("what OpenCASCADE reports is not the program's output") {
    const Sandbox box("reports");
    box.write("d.igs", igs_text());
    const Outcome outcome = box.run("info d.igs --unit m");
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, Catch::Matchers::StartsWith("d.igs\n") &&
                                Catch::Matchers::Contains("m in the file, m here"));
    CHECK(outcome.err.empty());
}

// By itself: OpenCASCADE reads a quarter of these until the time is over.
TEST_CASE("damaged BREP files are read or refused") {
    const Sandbox box("damaged-brep");
    write_cad(box / "d.brep");
    check_damaged(box / "d.brep", read_cad_surface);
}
#endif

#ifdef CONTROLSPACE_VTK
TEST_CASE("damaged files of VTK are read or refused") {
    const auto read_sources = [](const fs::path& file) { return read_vtk_sources(file); };
    const auto read_field = [](const fs::path& file) { return read_vtk_field(file); };
    const Sandbox box("damaged-vtk");
    box.write("d.vtp", vtp);
    check_damaged(box / "d.vtp", read_sources);
    check_damaged(made(box, "convert s.csv ", "d.vtu"), read_sources);
    check_damaged(made(box, "export s.csv --samples 5 -o ", "d.vti"), read_sources);
    check_damaged(made(box, "export s.csv -o ", "field.vtu"), read_field);
}
#endif

#ifdef CONTROLSPACE_OPENVDB
TEST_CASE("damaged files of OpenVDB are read or refused") {
    const Sandbox box("damaged-vdb");
    const std::string compression = GENERATE("blosc", "zip");
    const std::string command =
        "export s.csv --grids density,metric_diag,metric_off --voxel 0.25 --compression " +
        compression + " -o ";
    check_damaged(made(box, command, "d.vdb"), [](const fs::path& file) {
        return read_vdb_sources(file, {.grid = "density", .h = 0.1});
    });
    check_damaged(made(box, command, "field.vdb"),
                  [](const fs::path& file) { return read_vdb_field(file, {}); });
}
#endif

}  // namespace controlspace::damaged_files_test
