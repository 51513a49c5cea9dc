// SPDX-License-Identifier: Apache-2.0
// End to end: `controlspace info`, `convert` and `query`.
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "cli/sandbox.h"

namespace controlspace::files_test {

using Catch::Matchers::Contains;

namespace {

const std::string sizes_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";
const std::string tensors_csv =
    "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n"
    "0,0,0,0.3,0.4,0.5,0.02,-0.03,0.05\n1,2,3,0.35,0.45,0.55,-0.01,0.06,0.07\n";

/// That sources can be written in and read from.
const std::vector<std::string> formats{
    "csv", "mesh", "sol", "meshb", "solb", "pos",
#ifdef CONTROLSPACE_VTK
    "vtu", "vtp",
#endif
};

/// The numbers of a table, row by row.
std::vector<double> numbers_of(const std::string& csv) {
    std::vector<double> numbers;
    std::istringstream text(csv.substr(csv.find('\n') + 1));
    for (std::string cell; std::getline(text, cell, ',');) {
        std::istringstream line(cell);  // the last of a line and the first of the next
        for (double x = 0; line >> x;) numbers.push_back(x);
    }
    return numbers;
}

}  // namespace

TEST_CASE("info says what a file of sources holds") {
    const Sandbox box("info");
    box.write("s.csv", sizes_csv);
    const Outcome outcome = box.run("info s.csv");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(outcome.err.empty());
    CHECK_THAT(outcome.out, Contains("s.csv") && Contains("4, all positive definite") &&
                                Contains("[0, 1] x [0, 1] x [0, 1]") && Contains("0.1 to 0.4") &&
                                Contains("anisotropy   1 (largest)") &&
                                Contains("gradation    1.173 (largest"));
    CHECK_THAT(outcome.out, !Contains("conflicts"));
}

TEST_CASE("info counts the tensors that are not positive definite, other commands refuse them") {
    const Sandbox box("info-indefinite");
    const std::string head = "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n";
    box.write("t.csv", head +
                           "0,0,0,1,2,4,0,0,0\n# note\n0,0,1,1,1,1,2,0,0\n0,1,0,3,3,3,0,0,0\n"
                           "1,0,0,1,-1,1,0,0,0\n");
    box.write("all.csv", head + "0,0,0,1,1,1,2,0,0\n");
    box.write("m.mesh", "MeshVersionFormatted 2 Dimension 3 Vertices 2 0 0 0 0 1 1 1 0 End");
    box.write("m.sol",
              "MeshVersionFormatted 2 Dimension 3 SolAtVertices 2 1 3 4 0 4 0 0 4 1 2 1 0 0 1 End");
    const auto said = [&](const std::string& file) {
        const Outcome outcome = box.run("info " + file);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK(outcome.err.empty());
        return outcome.out;
    };
    CHECK_THAT(said("t.csv"),
               Contains("sources      4, 2 of them (50 %) positive definite; not so: 2, 4\n") &&
                   Contains("t.csv:4: tensor 2 (1 1 1 2 0 0) is not positive definite") &&
                   Contains("isotropic    1 of them") && Contains("lengths      1 to 4, ") &&
                   Contains("anisotropy   4 (largest)"));
    CHECK_THAT(said("all.csv"), Contains("1, 0 of them (0 %) positive definite; not so: 1\n") &&
                                    !Contains("lengths  "));
    CHECK_THAT(said("m.sol"), Contains("2, 1 of them (50 %)") && Contains("not so: 2\n") &&
                                  Contains("order of their components xx xy yy xz yz zz?"));
    check_refused(box.run("convert t.csv out.csv"), "t.csv:4: tensor");
    check_refused(box.run("convert m.sol out.csv"), "m.sol:1: tensor 2");
    // What else is wrong is said first.
    box.write("t.csv", head + "0,0,0,1,1,1,2,0,0\n0,0,0,1,1,1,2,0\n");
    check_refused(box.run("info t.csv"), "t.csv:3: 8 columns instead of 9");
}

TEST_CASE("sources that are converted there and back are the same") {
    const Sandbox box("convert");
    box.write("sizes.csv", sizes_csv);
    box.write("tensors.csv", tensors_csv);
    const std::string format = GENERATE(from_range(formats));
    for (const std::string name : {"sizes", "tensors"}) {
        CAPTURE(format, name);
        const Outcome there = box.run("convert " + name + ".csv out." + format);
        INFO(there.err);
        REQUIRE(there.status == 0);
        CHECK((there.out.empty() && there.err.empty()));
        REQUIRE(box.run("convert out." + format + " back.csv").status == 0);
        const auto before = numbers_of(file_text(box / (name + ".csv")));
        const auto after = numbers_of(file_text(box / "back.csv"));
        REQUIRE(before.size() == (name == "sizes" ? 16 : 18));
        REQUIRE(after.size() == before.size());
        for (std::size_t i = 0; i < before.size(); ++i) {
            CHECK(after[i] == Approx(before[i]).epsilon(1e-12).margin(1e-14));
        }
    }
}

TEST_CASE("an output that cannot be written is noticed before the input is read") {
    const Sandbox box("protected");
    box.write("broken.csv", "x,y,z,h\n0,0,0,none\n");
    const std::string out =
        GENERATE("build broken.csv -o out.ctrl", "export broken.csv -o out.vtu",
                 "export broken.csv -o out.npy", "convert broken.csv out.mesh",
                 "convert broken.csv -o out.csv", "query broken.csv broken.csv -o out.csv",
                 "info broken.csv -o out.txt");
    CAPTURE(out);
    const std::string name = out.substr(out.find("out."));
    box.write(name, "kept");
    check_refused(box.run(out, "chmod a-w " + name + "; "), name + ": it is write-protected");
    CHECK(file_text(box / name) == "kept");
    check_refused(box.run(out, "rm -f " + name + "; mkdir " + name + "; "),
                  name + ": it is a directory");
    const std::string elsewhere = std::string(out).replace(out.find(name), 0, "none/");
    check_refused(box.run(elsewhere), "cannot write none/" + name + ": No such file or directory");
    check_refused(box.run(out, "rm -rf " + name + "; "), "broken.csv:2");
}

TEST_CASE("query writes what a structure answers, as a table of sources") {
    const Sandbox box("query");
    box.write("s.csv", sizes_csv);
    box.write("study.toml", "sources = 's.csv'\nstructures = 'direct'\ng_r = 1.5\n");
    box.write("p.csv", "name,z,y,x\na,0,0,0\nb,0,0,0.2\n\nc,1,1,1\n");
    // The cones of the sources: 0.1 + 0.5 |v| from the first.
    const std::string expected = "x,y,z,h\n0,0,0,0.1\n0.2,0,0,0.2\n1,1,1,0.4\n";
    for (const char* arguments :
         {"study.toml p.csv", "s.csv p.csv --structures direct --g-r 1.5"}) {
        const Outcome outcome = box.run(std::string("query ") + arguments);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
        CHECK(outcome.out == expected);
    }
    const Outcome from_pipe =
        box.run("query - p.csv --structures direct --g-r 1.5 -o -", "cat s.csv | ");
    INFO(from_pipe.err);
    CHECK(from_pipe.out == expected);
    box.write("outside.csv", "x,y,z\n0,0,0\n5,0,0\n");
    CHECK_THAT(box.run("query s.csv outside.csv --quiet --structures K_oV").err,
               Contains("1 of 2 points are outside the domain ["));
    REQUIRE(box.run("query study.toml p.csv -o out.csv").status == 0);
    CHECK(file_text(box / "out.csv") == expected);
    CHECK_THAT(box.run("info out.csv").out, Contains("3, all positive definite"));
    // What standard output is sent to keeps what it holds.
    REQUIRE(
        box.run("query study.toml p.csv", "echo before >both; exec sh -c 'exec \"$@\" >>both' sh ")
            .status == 0);
    REQUIRE(file_text(box / "both") == "before\n" + expected);
    check_refused(box.run("query study.toml p.csv", "exec sh -c 'exec \"$@\" >&-' sh "),
                  "cannot write /dev/stdout");
}

TEST_CASE("commands on files that cannot be carried out end with one line") {
    const Sandbox box("files-refused");
    box.write("s.csv", sizes_csv);
    box.write("p.csv", "x,y\n0,0\n");
    box.write("none.csv", "x,y,z\n");
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"info", "FILE"},
        {"info no.csv", "no.csv: no such file"},
        {"info .", "is a directory"},
        {"convert s.csv", "OUT"},
        {"convert s.csv out.xyz", "out.xyz: name a .csv"},
        {"convert no.csv out.csv", "no.csv: no such file"},
        {"convert s.csv no/out.mesh", "cannot write"},
        {"convert s.csv out.csv --vdb-size x", "--vdb-size: 'x' is not a number"},
        {"info s.csv --source-array a",
         "source_array is for .vtu, .vtp, .vti, .vtk, .msh and .pos"},
        {"info s.csv --surface-h-min 1", "surface_h_min is for surfaces: .stl, .obj, .ply, .off, "},
        {"info s.csv --isotropic", "isotropic is for surfaces: .stl, .obj, .ply, .off, "},
        {"info s.stl --surface-crease 200", "--surface-crease: 200 is out of range"},
        {"info s.stl --elements-across 0", "--elements-across: 0 is not positive"},
        {"query s.csv", "POINTS"},
        {"query s.csv p.csv", "p.csv:1: column 'z' is missing: name the columns"},
        {"query s.csv none.csv", "none.csv holds no points"},
        {"query s.csv s.csv -o no/out.csv", "cannot write"},
        {"query s.csv s.csv --structures K_oL,K_V", "2 cases"},
        {"query no.toml s.csv", "no.toml"},
        {"query s.csv s.csv --tau 1,,2", "--tau 1,,2: a comma without a value"},
    }));
    INFO(arguments);
    check_refused(box.run(arguments), expected);
    for (const char* name : {"out.csv", "out.xyz", "out.mesh"}) CHECK_FALSE(fs::exists(box / name));
}

#ifdef CONTROLSPACE_CGAL
TEST_CASE("settings for surfaces are used, and vertices that are left out counted") {
    const Sandbox box("surface");
    box.write("plate.obj",
              "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"   // two plates,
              "v 0 0 0.1\nv 1 0 0.1\nv 1 1 0.1\nv 0 1 0.1\nf 5 6 7 8\n"  // 0.1 apart,
              "v 2 0 0\nv 3 0 0\nf 2 9 10\n");                           // and a line
    const auto finest = [&](const std::string& options) {
        const Outcome outcome = box.run("info plate.obj --surface-h-max 0.5 " + options);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK(lines(outcome.err) == 1);
        CHECK_THAT(outcome.err, Contains("plate.obj: 2 vertices are skipped: no triangle"));
        return outcome.out.substr(outcome.out.find("lengths"), 28);
    };
    CHECK_THAT(finest(""), Contains("0.05 to 0.5"));
    CHECK_THAT(finest("--elements-across 4"), Contains("0.025 to 0.5"));
    CHECK_THAT(finest("--isotropic"), Contains("0.05 to 0.05"));
    CHECK_THAT(
        box.run("info plate.obj").out,
        Contains("surface      4 triangles, 8 of 10 edges open\n") &&
            Contains("walls        behind 10000 of 10000 random places of the faces; the exact "
                     "field (g_r 1.25) is up to 1.") &&
            Contains("; more than 1.5x at 0\n"));
}
#endif

}  // namespace controlspace::files_test
