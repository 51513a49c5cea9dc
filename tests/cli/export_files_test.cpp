// End to end: `controlspace export` to files of meshers and of ParaView.
#include <catch2/catch.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/sandbox.h"

using namespace controlspace;
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
    CHECK_THAT(file_text(box / "back.csv"), Contains("\n0.25,0,0,0.2"));
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
