// SPDX-License-Identifier: Apache-2.0
// End to end: files of every format that cannot be read, each with its reason and its place. What
// else readers refuse: tests/sources, tests/mesh and tests/export.
#include <catch2/catch.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "cli/sandbox.h"
#include "sources/medit_bytes.h"

namespace controlspace::bad_input_test {

using Catch::Matchers::Contains;

namespace {

/// A file, and what is said of it.
struct BadFile {
    std::string name, content, expected;
};

const std::string byte_order_mark = "\xEF\xBB\xBF";
const std::string medit_head = "MeshVersionFormatted 2\nDimension 3\n";

/// A good mesh of one vertex, for solutions to lie beside.
const std::string mesh = medit_head + "Vertices\n1\n0 0 0 0\nEnd\n";

std::string solb(std::initializer_list<double> tensor) {
    MeditBytes file(2);
    file.block(62, 12 + 8 * tensor.size()).integer(1).word(1).word(tensor.size() == 1 ? 1 : 3);
    for (const double x : tensor) file.real(x);
    return file.end().bytes();
}

std::vector<BadFile> csv_files() {
    const std::string head = "x,y,z,h\n";
    return {
        {"f.csv", "", "f.csv is empty"},
        {"f.csv", head + "0,0,0,1\n0,0,", "f.csv:3: 3 columns instead of 4"},
        {"f.csv", "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n0,0,0,1,1,1,2,0,0\n",
         "f.csv:2: tensor 1 (1 1 1 2 0 0) is not positive definite"},
        {"f.csv", head + std::string("0,0,0,\0", 7), "holds a zero byte"},
    };
}

std::vector<BadFile> medit_files() {
    const std::string head = medit_head + "SolAtVertices\n";
    return {
        {"f.sol", "", "f.sol is empty"},
        {"f.sol", head + "1\n1 3\n1 0 1 0 0", "f.sol:6: the data end within tensor 1"},
        {"f.sol", head + "1\n1 3\n1 2 1 0 0 1\n",
         "f.sol:6: tensor 1 (1 2 1 0 0 1) is not positive definite"},
        {"f.sol", head + "2\n1 1\n1 1\n", "f.mesh has 1 vertices, and f.sol has sizes for 2"},
        {"f.solb", "", "f.solb is empty"},
        {"f.solb", solb({1}).substr(0, 40), "f.solb, byte "},
        {"f.solb", "solution of numbers\n", "f.solb:1: does not start with"},
        {"f.solb", solb({1, 2, 1, 0, 0, 1}),
         "f.solb, byte 88: tensor 1 (1 2 1 0 0 1) is not positive definite"},
    };
}

std::vector<BadFile> pos_files() {
    const std::string head = "View \"h\" {\n";
    return {
        {"f.pos", "", "f.pos is empty"},
        {"f.pos", head + "SP(0,0,0){1};\nSP(0,0,", "f.pos:3: the data end within an element"},
        {"f.pos", head + "SP(0,0,0){nan};\n};", "f.pos:2: size 1 is nan"},
    };
}

/// Two points with sizes, of which a part is replaced.
std::string vtu(const std::string& from = "", const std::string& to = "") {
    std::string text =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        "<UnstructuredGrid><Piece NumberOfPoints=\"2\" NumberOfCells=\"1\">\n"
        "<PointData><DataArray type=\"Float64\" Name=\"a:metric\" NumberOfComponents=\"1\" "
        "format=\"ascii\">0.5 0.25</DataArray></PointData>\n"
        "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n"
        "0 0 0 1 0 0</DataArray></Points>\n"
        "<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1</DataArray>\n"
        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">2</DataArray>\n"
        "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">3</DataArray></Cells>\n"
        "</Piece></UnstructuredGrid></VTKFile>\n";
    return from.empty() ? text : text.replace(text.find(from), from.size(), to);
}

std::vector<BadFile> vtk_files() {
    const std::string points = "NumberOfPoints=\"2\"", sizes = "0.5 0.25", good = vtu();
    const std::string tensors = "NumberOfComponents=\"1\" format=\"ascii\">0.5 0.25";
    return {
        {"f.vtu", "", "f.vtu is empty"},
        {"f.vtu", "solid s\n", "f.vtu: no VTKFile element"},
        {"f.vtu", good.substr(0, good.size() / 2), "f.vtu: VTK cannot read it: "},
        {"f.vtu", good.substr(0, good.size() - 40), "f.vtu: VTK cannot read it: "},
        {"f.vtu", vtu(sizes, "0.5 small"), "f.vtu: VTK cannot read it: "},
        {"f.vtu", vtu(points, "NumberOfPoints=\"2000000000\""), "f.vtu: "},
        {"f.vtu", vtu(points, "NumberOfPoints=\"-2\""), "f.vtu: "},
        {"f.vtu", vtu(points, "NumberOfPoints=\"3\""), "f.vtu: VTK cannot read it: "},
        {"f.vtu", vtu(sizes, "0.5 nan"), "f.vtu: "},
        {"f.vtu", vtu("Float64", "Float65"), "f.vtu: VTK cannot read it: "},
        {"f.vtu", vtu(sizes, "0.5 -1"), "f.vtu: size 2 is -1: a length must be positive"},
        {"f.vtu", vtu("0 0 0 1", "0 1e99 0 1"), "f.vtu: point 1 has a coordinate 1e+99"},
        {"f.vtu", vtu("a:metric", "a"),
         "f.vtu: no array is named :metric, there are 'a': name one"},
        {"f.vtu", vtu(tensors, "NumberOfComponents=\"6\" format=\"ascii\">1 1 1 0 0 0 1 1 1 2 0 0"),
         "f.vtu: tensor 2 (1 1 1 2 0 0) is not positive definite, 1 of 2 are not: is the order of "
         "their components XX YY ZZ XY YZ XZ?"},
        {"f.vtp", vtu(), "f.vtp: "},
    };
}

/// A mesh of three nodes with sizes, of which a part is replaced.
std::string msh(const std::string& from = "", const std::string& to = "") {
    std::string text =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
        "$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n"
        "$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n"
        "$NodeData\n1\n\"h\"\n1\n0\n3\n0\n1\n3\n1 0.5\n2 0.25\n3 0.125\n$EndNodeData\n";
    return from.empty() ? text : text.replace(text.find(from), from.size(), to);
}

std::vector<BadFile> msh_files() {
    return {
        {"f.msh", "", "f.msh is empty"},
        {"f.msh", "solid s\n", "f.msh:1: does not start with $MeshFormat"},
        {"f.msh", msh("4.1", "4.0"), "f.msh:2: format '4.0'"},
        {"f.msh", msh().substr(0, 60), "is it cut off?"},
        {"f.msh", msh().substr(0, msh().find("$NodeData")), "f.msh: no $NodeData"},
        {"f.msh", msh("1 3 1 3", "1 2000000000 1 3"), "f.msh:5: Nodes 200000000"},
        {"f.msh", msh("1 3 1 3", "1 -3 1 3"), "f.msh:5: Nodes: '-3' instead of a count"},
        {"f.msh", msh("2 1 0 3", "2 1 0 2000000000"), "f.msh:6: a block of 2000000000"},
        {"f.msh", msh("1 0.5", "1 nan"), "f.msh"},
        {"f.msh", msh("2 0.25", "2 -1"), "f.msh: size 2 is -1: a length must be positive"},
        {"f.msh", msh("1 0 0", "1 0 1e99"), "f.msh: node 2 has a coordinate 1e+99"},
        {"f.msh", msh("3 0.125", "7 0.125"), "f.msh"},
    };
}

std::vector<BadFile> surface_files() {
    const std::string ply_head = "ply\nformat ascii 1.0\nelement vertex ";
    const std::string ply_properties =
        "\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n";
    const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
    const std::string facet = "solid s\nfacet normal 0 0 1\nouter loop\n";
    std::string lying_stl(84, ' ');
    lying_stl.replace(80, 4, "\xFF\xFF\xFF\x7F", 4);
    return {
        {"f.stl", "", "f.stl is empty"},
        {"f.stl", "text\n", "f.stl: "},
        {"f.stl", facet + "vertex 0 0 0\nvertex 1", "f.stl:5: the data end within vertex 2"},
        {"f.stl", facet + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 one 0\nendloop\nendfacet\n",
         "f.stl:6: vertex 3: 'one' is not a number"},
        {"f.stl", lying_stl, "f.stl: "},
        {"f.obj", "", "f.obj is empty"},
        {"f.obj", "text\n", "f.obj: "},
        {"f.obj", "v 0 0 0\nv 1 0\n", "f.obj:2: vertex 2 has fewer than three coordinates"},
        {"f.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "f.obj: "},
        {"f.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9\n", "f.obj: "},
        {"f.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", "f.obj: "},
        {"f.ply", "", "f.ply is empty"},
        {"f.ply", "text\n", "f.ply: "},
        {"f.ply", ply_head + "2000000000" + ply_properties + corners + "3 0 1 2\n",
         "f.ply: no surface that can be read: is it cut off, or of another format?"},
        {"f.ply", ply_head + "-3" + ply_properties + corners + "3 0 1 2\n", "f.ply: "},
        {"f.ply", ply_head + "3" + ply_properties + "0 0 0\n1 0", "f.ply: "},
        {"f.ply", ply_head + "3" + ply_properties + corners + "3 0 1 7\n", "f.ply: "},
        {"f.ply", ply_head + "3" + ply_properties + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "f.ply: "},
        {"f.off", "OFF\n2000000000 1 0\n" + corners + "3 0 1 2\n",
         "f.off: no surface that can be read: is it cut off, or of another format?"},
        {"f.off", "OFF\n3 1 0\n" + corners + "3 0 1 7\n", "f.off: "},
    };
}

std::vector<std::vector<BadFile> (*)()> all_formats() {
    return {
        csv_files,     medit_files, pos_files, msh_files,
#ifdef CONTROLSPACE_VTK
        vtk_files,
#endif
#ifdef CONTROLSPACE_CGAL
        surface_files,
#endif
    };
}

}  // namespace

TEST_CASE("a file that cannot be read is refused in one line that names the place") {
    const auto files = GENERATE(from_range(all_formats()));
    for (const BadFile& file : files()) {
        const Sandbox box("bad-input");
        box.write("f.mesh", mesh);
        box.write(file.name, file.content);
        INFO(file.name << ": " << file.content);
        check_refused(box.run("convert " + file.name + " out.csv"), file.expected);
        CHECK_FALSE(fs::exists(box / "out.csv"));
    }
}

TEST_CASE("a folder is no file of sources, whatever it is called") {
    const std::string ending = GENERATE("csv", "mesh", "meshb", "sol", "solb", "pos", "msh", "vtu",
                                        "vtp", "stl", "obj", "ply", "off");
    const Sandbox box("bad-folder");
    fs::create_directory(box / ("f." + ending));
    check_refused(box.run("info f." + ending), "f." + ending + " is a directory");
}

TEST_CASE("a byte order mark and the line ends of Windows are passed over") {
    const Sandbox box("windows");
    box.write("f.csv", byte_order_mark + "x,y,z,h\r\n0,0,0,1\r\n1,0,0,2\r\n");
    box.write("f.mesh", byte_order_mark +
                            "MeshVersionFormatted 2\r\nDimension\r\n3\r\nVertices\r\n1\r\n"
                            "0 0 0 0\r\nEnd\r\n");
    box.write("f.sol", byte_order_mark +
                           "MeshVersionFormatted 2\r\nDimension 3\r\nSolAtVertices\r\n1\r\n1 1\r\n"
                           "2\r\nEnd\r\n");
    CHECK_THAT(box.run("info f.csv").out, Contains("1 to 2"));
    CHECK_THAT(box.run("info f.sol").out, Contains("2 to 2"));
}

}  // namespace controlspace::bad_input_test
