// End to end: damaged files of formats that other libraries read, and that may bring these down.
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <sstream>

#include "cli/sandbox.h"
#include "damaged_copies.h"

using namespace controlspace;

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

const std::string msh =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n"
    "0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n"
    "$NodeData\n1\n\"h\"\n1\n0\n3\n0\n1\n3\n1 0.5\n2 0.25\n3 0.125\n$EndNodeData\n";

/// Reads all copies of a file that were damaged: the program ends as its help says.
void check_damaged(const Sandbox& box, const std::string& name, const std::string& bytes,
                   const std::string& command = "info ") {
    CAPTURE(name);
    box.write(name, bytes);
    REQUIRE(box.run(command + name).status == 0);
    int copy = 0;
    for (const std::string& damaged : damaged_copies(bytes, 5)) {
        CAPTURE(copy++);
        box.write(name, damaged);
        const Outcome outcome = box.run(command + name);
        CAPTURE(outcome.err);
        CHECK((outcome.status == 0 || outcome.status == 2));
        // Triangles without an area are no error.
        if (outcome.status == 0 && !outcome.err.empty()) {
            CHECK_THAT(outcome.err, Catch::Matchers::Contains("vertices are skipped"));
        }
        if (outcome.status != 0 || !outcome.err.empty()) CHECK(lines(outcome.err) == 1);
        CHECK(outcome.out.empty() == (outcome.status != 0));
    }
}

}  // namespace

#ifdef CONTROLSPACE_CGAL
TEST_CASE("damaged files of surfaces are read or refused") {
    const auto [name, bytes] = GENERATE(table<std::string, std::string>({{"d.off", off_text()},
                                                                         {"d.ply", ply_text()},
                                                                         {"b.ply", ply_bytes()},
                                                                         {"d.obj", obj_text()},
                                                                         {"d.stl", stl_text()},
                                                                         {"b.stl", stl_bytes()}}));
    check_damaged(Sandbox("damaged-surfaces"), name, bytes);
}
#endif

TEST_CASE("damaged meshes of Gmsh are read or refused") {
    check_damaged(Sandbox("damaged-msh"), "d.msh", msh);
}

#ifdef CONTROLSPACE_VTK
TEST_CASE("damaged files of VTK are read or refused") {
    const Sandbox box("damaged-vtk");
    check_damaged(box, "d.vtp", vtp);
    box.write("s.csv", "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n");
    REQUIRE(box.run("convert s.csv d.vtu").status == 0);
    check_damaged(box, "d.vtu", file_text(box / "d.vtu"));
}
#endif

#ifdef CONTROLSPACE_OPENVDB
TEST_CASE("damaged files of OpenVDB are read or refused") {
    const Sandbox box("damaged-vdb");
    box.write("s.csv", "x,y,z,h\n0,0,0,0.3\n1,0,0,0.3\n0,1,0,0.3\n1,1,1,0.4\n");
    const std::string compression = GENERATE("blosc", "zip");
    REQUIRE(box.run("export s.csv --grids density,metric_diag,metric_off --voxel 0.25 -o d.vdb "
                    "--compression " +
                    compression)
                .status == 0);
    const std::string bytes = file_text(box / "d.vdb");
    check_damaged(box, "d.vdb", bytes, "info --vdb-grid density --vdb-size 0.1 ");
    check_damaged(box, "d.vdb", bytes,
                  "compare --structures K_oL --dry-run --sources none --field file --field-file ");
}
#endif
