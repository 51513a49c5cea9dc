// SPDX-License-Identifier: Apache-2.0
// End to end: `controlspace export` to files of meshers and of ParaView.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/sandbox.h"

namespace controlspace::export_files_test {

using Catch::Matchers::Contains;

namespace {

const std::string sources_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";

const std::vector<std::pair<std::string, std::string>> refused{
    {"-o out.xyz", "out.xyz: name a file of one of .csv, "},
    {"-o out.sol", "name the mesh of the solution by --mesh"},
    {"-o out.csv --mesh m.mesh", "--mesh is for .sol and .solb"},
    {"-o out.sol --mesh none.mesh", "none.mesh"},
    {"-o no/out.csv", "cannot write"},
    {"-o out.htg --structures K_L", "only an octree"},
    {"-o out.vti --slice q", "--slice: 'q' is no axis"},
    {"-o out.vti --slice z top", "--slice: 'top' is not a number"},
    {"-o out.vti --slice z 9", "a slice at z = 9 is outside the domain"},
    {"-o out.vti --samples 1", "1 samples"},
    {"-o out.vti --samples 8193", "8193 samples: give 2 to 8192"},
    {"-o out.vti --lengths --samples 131073", "131073 samples: give 2 to 131072"},
    {"-o out.npy --samples 1", "1 samples"},
    {"-o out.npy --lengths", "--lengths is for .vti: leave it out"},
    {"-o out.npy --slice z 9", "a slice at z = 9 is outside the domain"},
    {"-o no/out.npy", "cannot write"},
    {"-o no/out.vtu", "cannot write"},
};

}  // namespace

TEST_CASE("metrics at the vertices of a mesh are those of the structure") {
    const Sandbox box("export-sol");
    box.write("s.csv", sources_csv);
    box.write(
        "m.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n3\n0 0 0 0\n0.25 0 0 0\n1 1 1 0\nEnd\n");
    const std::string ending = GENERATE("sol", "solb");
    const Outcome outcome =
        box.run("export s.csv -o m." + ending + " --mesh m.mesh --structures direct --g-r 1.4");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, Contains("metrics at the 3 vertices of m.mesh"));
    // Cones: 0.1 + 0.4 * 0.25 from the first source; and the last source itself.
    const Outcome info = box.run("info m." + ending);
    INFO(info.err);
    CHECK_THAT(info.out, Contains("3, all positive definite") && Contains("0.1 to 0.4"));
    REQUIRE(box.run("convert m." + ending + " back.csv").status == 0);
    CHECK_THAT(file_text(box / "back.csv"),
               Contains("\n0.25,0,0,0.2") || Contains("\n0.25,0,0,0.1999999999999"));
    CHECK_THAT(box.run("export s.csv -o m." + ending + " --mesh m.mesh --domain 0,2,0,2,0,2").err,
               !Contains("outside"));
    box.write(
        "m.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n3\n0 0 0 0\n0.25 0 9 0\n1 1 1 0\nEnd\n");
    CHECK_THAT(box.run("export s.csv -o m." + ending + " --mesh m.mesh").err,
               Contains("1 of 3 vertices are outside the domain [") &&
                   Contains("all are in [0, 1] x [0, 1] x [0, 9] (--domain)"));
}

namespace {

/// The doubles at the end of some bytes.
std::vector<double> doubles_in(std::string bytes, std::size_t count, bool are_reversed) {
    REQUIRE(bytes.size() >= count * sizeof(double));
    std::vector<double> numbers(count);
    bytes.erase(0, bytes.size() - count * sizeof(double));
    for (std::size_t i = 0; i < count; ++i) {
        std::string one = bytes.substr(i * sizeof(double), sizeof(double));
        if (are_reversed) std::reverse(one.begin(), one.end());
        std::memcpy(&numbers[i], one.data(), sizeof(double));
    }
    return numbers;
}

}  // namespace

TEST_CASE("lengths of a slice, for NumPy, ParaView and netCDF, are those of single places",
          "[threads]") {
    const Sandbox box("export-lengths");
    box.write("s.csv", "x,y,z,h,g\n0.2,0.1,0.3,0.1,1.5\n1.7,0.6,0.4,0.05,0\n1,1,0,0.2,1\n");
    // Tiles that are not full, in both directions; the axes are x and z, of a plane or a slice.
    const std::string domain =
        GENERATE(" --domain 0 2 0.5 0.5 0 1", " --domain 0 2 0 1 0 1 --slice y 0.5");
    if (domain.find("slice") == domain.npos) {
        box.write("s.csv", "x,y,z,h,g\n0.2,0.5,0.3,0.1,1.5\n1.7,0.5,0.4,0.05,0\n");
    }
    constexpr std::size_t columns = 101, rows = 51;
    const std::string options = domain + " --structures direct --samples 101";
    for (const std::string file : {"a.npy", "a.vti --lengths"}) {
        const Outcome outcome = box.run("export s.csv -o " + file + options);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
        CHECK_THAT(outcome.out, Contains("101 x 51 lengths at y = 0.5"));
    }
    const std::string npy = file_text(box / "a.npy");
    CHECK(npy.size() == 128 + rows * columns * sizeof(double));
    CHECK_THAT(npy, Contains("'shape': (51, 101)"));
    const std::vector<double> lengths = doubles_in(npy, rows * columns, false);

    std::string places = "x,y,z\n";
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i < columns; ++i) {
            places += fmt::format("{},0.5,{}\n", 0.02 * static_cast<double>(i),
                                  0.02 * static_cast<double>(j));
        }
    }
    box.write("places.csv", places);
    const std::string no_slice = domain.substr(0, domain.find(" --slice"));
    REQUIRE(
        box.run("query s.csv places.csv --structures direct -o answers.csv" + no_slice).status ==
        0);
    std::istringstream answers(file_text(box / "answers.csv"));
    std::string line;
    std::getline(answers, line);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < lengths.size() && std::getline(answers, line); ++i) {
        const double h = std::stod(line.substr(line.rfind(',') + 1));
        if (std::abs(h - lengths[i]) > 1e-12) ++wrong;
    }
    CHECK(wrong == 0);

    const std::string tail = "\n</AppendedData>\n</VTKFile>\n";
    std::string vti = file_text(box / "a.vti");
    CHECK_THAT(vti, Contains("WholeExtent=\"0 100 0 0 0 50\"") && Contains("Name=\"h\""));
    REQUIRE(vti.ends_with(tail));
    vti.resize(vti.size() - tail.size());
    CHECK(doubles_in(vti, lengths.size(), false) == lengths);
#ifdef CONTROLSPACE_VTK
    // VTK reads the file, as sources.
    REQUIRE(box.run("export a.vti --source-array h -o read.csv --structures direct" + no_slice)
                .status == 0);
    CHECK(lines(file_text(box / "read.csv")) == 1 + lengths.size());
#endif
#ifdef CONTROLSPACE_NETCDF
    const Outcome outcome = box.run("export s.csv -o a.nc" + options);
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    const std::string nc = file_text(box / "a.nc");
    CHECK(nc.starts_with("CDF\x02"));  // as SciPy reads it
    CHECK(doubles_in(nc, lengths.size(), true) == lengths);
#endif
}

TEST_CASE("a raster that the disk cannot hold is refused before anything is written") {
    const Sandbox box("export-room");
    box.write("s.csv", "x,y,z,h\n0.2,0.5,0,0.1\n");
    const Outcome outcome = box.run(
        "export s.csv -o big.npy --domain 0 1 0 1 0 0 --structures direct --samples 131072");
    // 137 GB; a disk that has them is not filled by a test.
    if (fs::space(box / "").available < 137'500'000'000) {
        check_refused(outcome, "the disk has");
        CHECK_THAT(outcome.err, Contains("big.npy: it takes 137439.0 MB"));
    }
    CHECK(!fs::exists(box / "big.npy"));
}

TEST_CASE("sources are read from an array of NumPy as from a table") {
    const Sandbox box("sources-npy");
    const auto array = [](const std::string& shape, const std::string& type,
                          std::vector<double> numbers) {
        std::string header =
            "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }\n";
        std::string bytes("\x93NUMPY\x01\x00", 8);
        bytes += static_cast<char>(header.size());
        bytes += '\0';
        bytes += header;
        bytes.append(reinterpret_cast<const char*>(numbers.data()),
                     numbers.size() * sizeof(double));
        return bytes;
    };
    const std::vector<double> two{0, 0, 0, 0.1, 1.5, 1, 0.25, 0, 0.2, 0};
    box.write("a.npy", array("(2, 5)", "<f8", two));
    const Outcome outcome = box.run("convert a.npy a.csv");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(file_text(box / "a.csv") == "x,y,z,h,g\n0,0,0,0.1,1.5\n1,0.25,0,0.2,0\n");
    box.write("b.npy", array("(1, 4)", "<f8", {0, 0, 0, 0.1}));
    REQUIRE(box.run("convert b.npy b.csv").status == 0);
    CHECK(file_text(box / "b.csv") == "x,y,z,h\n0,0,0,0.1\n");

    const std::array<float, 4> narrow{0, 1, 0.5F, 0.125F};
    std::vector<double> halves(2);
    std::memcpy(halves.data(), narrow.data(), sizeof narrow);
    box.write("c.npy", array("(1, 4)", "<f4", halves));
    REQUIRE(box.run("convert c.npy c.csv").status == 0);
    CHECK(file_text(box / "c.csv") == "x,y,z,h\n0,1,0.5,0.125\n");

    const std::vector<std::pair<std::string, std::string>> damaged{
        {array("(3, 5)", "<f8", two), "it has 2 of 3 rows"},
        {array("(5, 2)", "<f8", two), "its shape is (5, 2): give rows"},
        {array("(10,)", "<f8", two), "its shape is (10,): give rows"},
        {array("(2, 5)", "<i4", two), "it holds no floats or doubles"},
        {array("(9, 5)", "<f4", two), "it has 4 of 9 rows"},
        {array("(2, 5)", "<f8", {0, 0, 0, 1, 1, 0, 0, 0, -1, 1}),
         "row 1: h = -1: a length must be positive"},
        {array("(2, 5)", "<f8", {0, 0, 0, 1, 0.5, 0, 0, 0, 1, 1}),
         "row 0: g = 0.5: give the gradation ratio"},
        {array("(1, 4)", "<f8", {0, std::nan(""), 0, 1}), "row 0: y = nan: give a finite number"},
        {array("(2, 5)", "<f8", two).substr(0, 30), "it is cut off"},
        {"x,y,z,h\n0,0,0,1\n", "it is no array of NumPy"}};
    for (const auto& [bytes, message] : damaged) {
        box.write("bad.npy", bytes);
        CAPTURE(message);
        const Outcome refused = box.run("convert bad.npy bad.csv");
        CHECK(refused.status == 2);
        CHECK_THAT(refused.err, Contains("bad.npy") && Contains(message));
        CHECK(!fs::exists(box / "bad.csv"));
    }
}

TEST_CASE("control nodes as a table are sources again") {
    const Sandbox box("export-csv");
    box.write("s.csv", sources_csv);
    const Outcome outcome = box.run("export s.csv -o nodes.csv");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, Contains("control nodes"));
    CHECK_THAT(box.run("info nodes.csv").out, Contains("lengths      0.10"));
    CHECK_THAT(box.run("export s.csv -o cells.pos").out, Contains("hexahedra"));
    CHECK_THAT(file_text(box / "cells.pos"), Contains("\nSH("));
}

TEST_CASE("a plane is exported as one, and compared") {
    const Sandbox box("export-plane");
    box.write("s.csv", "x,y,z,h\n0.2,0,0.3,0.1\n0.7,0,0.4,0.05\n");
    const std::string plane = " --domain 0 1 0 0 0 1";
    for (const std::string file : {"a.vtu", "a.vtu --nodes", "a.vti", "a.htg", "a.pos", "a.csv"}) {
        const Outcome outcome = box.run("export s.csv -o " + file + plane);
        INFO(file << outcome.err);
        CHECK(outcome.status == 0);
    }
    CHECK_THAT(file_text(box / "a.pos"), Contains("\nSQ("));
    CHECK_THAT(file_text(box / "a.vti"), Contains("WholeExtent=\"0 511 0 0 0 511\""));
    const Outcome compared = box.run(
        "compare --sources s.csv --output r --access-points 100 --structures "
        "K_L,K_V,K_oLi,K_oV,K_oLA,uniform-trilinear,openvdb-uniform-trilinear" +
        plane);
    INFO(compared.err);
    CHECK(compared.status == 0);
    CHECK_THAT(box.run("export s.csv -o a.vtu --domain 0 1 1 1 0 1").err,
               Contains("outside") && Contains("source 0"));
    CHECK_THAT(box.run("export s.csv -o a.vtu --domain 0 1 0 0 0 0").err,
               Contains("no extent along two axes"));
}

TEST_CASE("elements, nodes, octrees and slices are files for ParaView") {
    const Sandbox box("export-vtk");
    box.write("s.csv", sources_csv);
    for (const char* arguments :
         {"-o a.vtu --structures K_L", "-o a.vtu --nodes", "-o a.htg --structures K_oV", "-o a.vti",
          "-o a.vti --slice x 0.25 --samples 33", "-o a.vtu --structures uniform-nearest",
          "-o a.vtu --structures K_oLA"}) {
        INFO(arguments);
        const Outcome outcome = box.run(std::string("export s.csv ") + arguments);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK(lines(outcome.err) == 1);
        CHECK_THAT(outcome.err, Contains(": lengths within ") || Contains("everywhere: lengths "));
        CHECK_THAT(outcome.out, Catch::Matchers::StartsWith("a.v") ||
                                    Catch::Matchers::StartsWith("a.htg: an octree"));
    }
    REQUIRE(box.run("export s.csv -o nodes.vtu --nodes --structures K_V").status == 0);
#ifdef CONTROLSPACE_VTK
    CHECK_THAT(box.run("info a.vtu").out, Contains("all positive definite"));
    CHECK_THAT(box.run("info nodes.vtu").out, Contains("lengths      0.10"));
#endif
}

TEST_CASE("a control space that was saved is exported as it was") {
    const Sandbox box("export-loaded");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("build s.csv -o f.ctrl --structures K_oV").status == 0);
    REQUIRE(box.run("export s.csv -o made.csv --structures K_oV").status == 0);
    const Outcome loaded = box.run("export f.ctrl -o loaded.csv");
    INFO(loaded.err);
    REQUIRE(loaded.status == 0);
    CHECK(file_text(box / "loaded.csv") == file_text(box / "made.csv"));
    check_refused(box.run("export f.ctrl -o a.csv --tau 0.5"), "--tau");
#ifdef CONTROLSPACE_OPENVDB
    CHECK(box.run("export f.ctrl -o loaded.vdb --voxel 0.1").status == 0);
    check_refused(box.run("export f.ctrl -o a.vdb --grids sources"), "keeps no sources");
    CHECK_FALSE(fs::exists(box / "a.vdb"));
#endif
}

TEST_CASE("files of fields that cannot be written end with one line") {
    const Sandbox box("export-files-refused");
    box.write("s.csv", sources_csv);
    box.write("m.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nEnd\n");
    const auto [arguments, expected] = GENERATE(from_range(refused));
    INFO(arguments);
    check_refused(box.run("export s.csv " + arguments), expected);
    for (const char* name : {"out.csv", "out.sol", "out.htg", "out.vti"}) {
        CHECK_FALSE(fs::exists(box / name));
    }
}

}  // namespace controlspace::export_files_test
