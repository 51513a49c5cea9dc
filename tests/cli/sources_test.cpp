// SPDX-License-Identifier: Apache-2.0
// End to end: primitives, limits, data of cells, and exports that are read again.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "cli/sandbox.h"

namespace controlspace::sources_test {

using Catch::Matchers::Contains;

namespace {

using Row = std::vector<double>;

/// Rows of a table without its head.
std::vector<Row> rows_of(const std::string& csv) {
    std::vector<Row> rows;
    std::istringstream text(csv.substr(csv.find('\n') + 1));
    for (std::string line; std::getline(text, line);) {
        Row& row = rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    }
    return rows;
}

/// A grid of places in [0.05, 0.95]^3.
const std::string places = [] {
    std::ostringstream text;
    text << "x,y,z\n";
    for (int i = 0; i < 1000; ++i) {
        text << 0.05 + 0.1 * (i % 10) << ',' << 0.05 + 0.1 * (i / 10 % 10) << ','
             << 0.05 + 0.1 * (i / 100) << '\n';
    }
    return text.str();
}();

/// Largest factor between the lengths of a structure at the places and those expected there.
template <class Expected>
double worst(const Outcome& query, const Expected& expected) {
    INFO(query.err);
    REQUIRE(query.status == 0);
    const auto rows = rows_of(query.out);
    REQUIRE(rows.size() == 1000);
    double factor = 1;
    for (const Row& row : rows) {
        const double h = expected(row[0], row[1], row[2]);
        factor = std::max({factor, row[3] / h, h / row[3]});
    }
    return factor;
}

const std::string domain = " --domain 0,1,0,1,0,1";

}  // namespace

TEST_CASE("primitives make the field of their closed form, alone and beside a file") {
    const Sandbox box("primitives");
    box.write("places.csv", places);
    box.write("s.csv", "x,y,z,h\n0.9,0.9,0.9,0.03\n0,0,0,0.2\n");
    const std::string ball = "ball:0.3,0.4,0.5,r=0.1,h=0.02",
                      slab = "box:0,1,0,1,0,0.1,h=0.05,g=1.1";
    const auto of_ball = [](double x, double y, double z) {
        const double d = std::hypot(x - 0.3, y - 0.4, z - 0.5) - 0.1;
        return 0.02 + 0.25 * std::max(0.0, d);
    };
    const auto of_all = [&](double x, double y, double z) {
        return std::min({of_ball(x, y, z), 0.05 + 0.1 * std::max(0.0, z - 0.1),
                         0.03 + 0.25 * std::hypot(x - 0.9, y - 0.9, z - 0.9)});
    };
    const Outcome built = box.run("build --sources " + ball + domain + " -o f.ctrl");
    CHECK_THAT(built.err, Contains("lengths within 1.1x") || Contains("lengths within 1.0"));
    CHECK(worst(box.run("query f.ctrl places.csv"), of_ball) <= 1.1);

    // A file, given first or among the others; in words and in a study file.
    REQUIRE(box.run("build s.csv --sources " + ball + "," + slab + domain + " -o g.ctrl").status ==
            0);
    const Outcome all = box.run("query g.ctrl places.csv");
    CHECK(worst(all, of_all) <= 1.1);
    box.write("study.toml", "sources = ['s.csv', '" + ball + "', '" + slab +
                                "']\ndomain = [0, 1, 0, 1, 0, 1]\nstructures = 'K_oV'\n");
    CHECK(box.run("query study.toml places.csv").out == all.out);
    CHECK(box.run("build --sources " + slab + ",s.csv," + ball + domain + " -o h.ctrl").status ==
          0);
    CHECK(worst(box.run("query h.ctrl places.csv"), of_all) <= 1.1);

    const Outcome compare = box.run("compare --sources s.csv," + ball +
                                    " --structures K_oV,uniform-trilinear,direct --quiet "
                                    "--access-points 10 --probe-grid 5 --fine-probe-grid 5");
    INFO(compare.err);
    CHECK(compare.status == 0);
}

TEST_CASE("limits hold at all places, in all kinds of structures") {
    const Sandbox box("limits");
    box.write("places.csv", places);
    box.write("s.csv", "x,y,z,h\n0.5,0.5,0.5,0.001\n");
    const auto expected = [](double x, double y, double z) {
        return std::min(0.12, 0.05 + 0.25 * std::hypot(x - 0.5, y - 0.5, z - 0.5));
    };
    const std::string limits = domain + " --h-min 0.05 --h-max 0.12";
    CHECK(worst(box.run("query s.csv places.csv" + limits), expected) <= 1.1);
    CHECK(worst(box.run("query s.csv places.csv --structures direct" + limits), expected) <
          1 + 1e-9);
    CHECK_THAT(box.run("build s.csv -o f.ctrl" + limits).err, Contains("everywhere"));
    check_refused(box.run("build s.csv -o no.ctrl --h-min 2 --h-max 1"), "give h_min <= h_max");
    check_refused(box.run("build s.csv -o no.ctrl --h-max -1"), "--h-max: -1");
}

TEST_CASE("sources that cannot be used are named in one line") {
    const Sandbox box("sources-refused");
    box.write("s.csv", "x,y,z,h\n# far\n0,0,0,0.1\n5,5,5,0.1\n");
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"s.csv --domain 0,1,0,1,0,1", "source 1 (s.csv, line 4) at (5, 5, 5) lies outside"},
        {"--sources ball:0,0,0,r=-1,h=0.1", "--sources: ball:0,0,0,r=-1,h=0.1: r is -1"},
        {"--sources s.csv,ball:9,9,9,r=1,h=0.1", "ball:9,9,9,r=1,h=0.1 lies outside the domain"},
        {"--sources box:0,1,0,1,1,0,h=0.1", "give z0 < z1"},
        {"--sources ball:0,0,0,r=1,h=0.1,k=2", "unknown setting 'k'"},
        {"--sources ball:0,0,0,r=1,h=0.1,nan.csv", "nan.csv: no such file"},
        {"--sources surface:s.csv,h=0.1", "s.csv is no part"},
        {"s.csv --sources sphere", "--sources sphere does not go with s.csv"},
    }));
    CAPTURE(arguments);
    check_refused(box.run("build -o out.ctrl " + arguments), expected);
    CHECK_FALSE(fs::exists(box / "out.ctrl"));
}

TEST_CASE("an input and --sources are joined by all commands") {
    const Sandbox box("joined");
    box.write("places.csv", places);
    box.write("s.csv", "x,y,z,h\n0.1,0.9,0.2,0.02\n");
    const std::string ball = "ball:0.7,0.3,0.5,r=0.1,h=0.03";
    const auto expected = [](double x, double y, double z) {
        const double from_ball = std::max(0.0, std::hypot(x - 0.7, y - 0.3, z - 0.5) - 0.1);
        return std::min(0.02 + 0.25 * std::hypot(x - 0.1, y - 0.9, z - 0.2),
                        0.03 + 0.25 * from_ball);
    };
    for (const std::string& arguments :
         {"s.csv places.csv --sources " + ball, ball + " places.csv --sources s.csv",
          "s.csv," + ball + " places.csv"}) {
        CAPTURE(arguments);
        CHECK(worst(box.run("query --structures direct " + arguments + domain), expected) <
              1 + 1e-9);
    }
    const Outcome compared =
        box.run("compare s.csv --quiet --structures direct --dry-run --sources " + ball + domain);
    CHECK(compared.status == 0);
    check_refused(box.run("compare s.csv --sources sphere"), "does not go with s.csv");
    check_refused(box.run("query s.csv --pipe --sources -" + domain), "standard input");
    check_refused(box.run("convert s.csv," + ball + " out.csv"), "is no set of points");
    check_refused(box.run("convert s.csv,s.csv s.csv"), "name another output");
    check_refused(box.run("info s.csv,s.csv -o s.csv"), "name another output");
    box.write("g.csv", "x,y,z,h,g\n0.1,0.9,0.2,0.02,1.5\n");
    check_refused(box.run("convert g.csv out.pos"), "only a .csv holds gradation ratios");
    CHECK(box.run("convert g.csv again.csv").status == 0);
    CHECK_FALSE(fs::exists(box / "out.csv"));
}

#ifdef CONTROLSPACE_CGAL
TEST_CASE("lengths grow with the distance from a surface, on both sides") {
    const Sandbox box("surface-distance");
    box.write("places.csv", places);
    // The plane z = 0.5 as two triangles, beyond the domain.
    box.write("plane.off",
              "OFF\n4 2 0\n-1 -1 0.5\n2 -1 0.5\n2 2 0.5\n-1 2 0.5\n3 0 1 2\n3 0 2 3\n");
    const auto expected = [](double, double, double z) { return 0.05 + 0.5 * std::abs(z - 0.5); };
    const std::string source = "surface:plane.off,h=0.05,g=1.5";
    const std::string study = "sources = '" + source + "'\ndomain = [0, 1, 0, 1, 0, 1]\n";
    box.write("study.toml", study + "structures = 'direct'\n");
    CHECK(worst(box.run("query study.toml places.csv"), expected) < 1 + 1e-9);
    fs::create_directory(box / "parts");
    fs::rename(box / "plane.off", box / "parts" / "plane.off");
    box.write("parts/study.toml", study + "structures = 'K_V'\n");
    // Linear on both sides of a plane where leaves are split.
    CHECK(worst(box.run("query parts/study.toml places.csv"), expected) < 1 + 1e-9);
    fs::copy_file(box / "parts/plane.off", box / "parts/plane.csv");
    check_refused(box.run("build --sources surface:parts/plane.csv,h=1 -o f.ctrl"), "is no part");
    check_refused(box.run("build --sources surface:none.stl,h=1 -o f.ctrl"), "none.stl");
}
#endif

#ifdef CONTROLSPACE_VTK
TEST_CASE("exports are sources again: the field that is graded from them is close to theirs") {
    const Sandbox box("read-again");
    box.write("places.csv", places);
    box.write("s.csv", "x,y,z,h\n0.5,0.5,0.5,0.05\n0.1,0.9,0.2,0.02\n");
    const auto expected = [](double x, double y, double z) {
        return std::min(0.05 + 0.25 * std::hypot(x - 0.5, y - 0.5, z - 0.5),
                        0.02 + 0.25 * std::hypot(x - 0.1, y - 0.9, z - 0.2));
    };
    REQUIRE(box.run("build s.csv -o f.ctrl --within 1.05" + domain).status == 0);
    REQUIRE(box.run("export f.ctrl -o leaves.vtu").status == 0);
    REQUIRE(box.run("export f.ctrl -o nodes.vtu --nodes").status == 0);
    REQUIRE(box.run("export f.ctrl -o slice.vti --samples 41").status == 0);
    for (const char* file : {"leaves.vtu", "nodes.vtu"}) {
        CAPTURE(file);
        const Outcome direct =
            box.run("query " + std::string(file) + domain + " --structures direct places.csv");
        // The requests are within 1.05, and cones of the same slope from them stay there.
        CHECK(worst(direct, expected) <= 1.05);
    }
    // As a finished field: which it is, tests/export says.
    box.write("again.toml",
              "sources = 'none'\nfield = 'file'\nfield_file = 'leaves.vtu'\n"
              "structures = 'direct'\n");
    CHECK(rows_of(box.run("query again.toml places.csv").out).size() == 1000);
    CHECK_THAT(box.run("info slice.vti").out, Contains("sources      1681, all positive definite"));
    CHECK(box.run("convert leaves.vtu leaves.csv").status == 0);
}
#endif

TEST_CASE("a mesh without a solution is said to give the lengths of its required edges") {
    const Sandbox box("mesh-alone");
    const std::string mesh =
        "MeshVersionFormatted 2 Dimension 3 Vertices 3 0 0 0 0  3 0 0 0  3 4 0 0 "
        "Edges 1 1 2 0 RequiredEdges 1 1 End";
    box.write("a.mesh", mesh);
    const Outcome alone = box.run("convert a.mesh a.csv");
    CHECK(alone.status == 0);
    CHECK_THAT(alone.err, Contains("a.mesh has no solution beside it") && Contains("2 vertices"));
    box.write("b.mesh", mesh);
    box.write("b.sol", "MeshVersionFormatted 2 Dimension 3 SolAtVertices 3 1 1 1 1 1 End");
    CHECK(box.run("convert b.mesh b.csv").err.empty());
}

TEST_CASE("a file's name may follow the numbers of an option") {
    const Sandbox box("after-domain");
    box.write("s.csv", "x,y,z,h\n0.2,0.5,0.5,0.1\n");
    box.write("p.csv", "x,y,z\n0,0,0\n1,0,0\n");
    for (const char* domain : {"--domain 0 1 0 1 0 1", "--domain 0,1,0,1,0,1"}) {
        const Outcome outcome = box.run(std::string("query ") + domain + " s.csv p.csv --quiet");
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK(lines(outcome.out) == 3);
        CHECK(box.run(std::string("query s.csv ") + domain + " p.csv --quiet").out == outcome.out);
    }
    check_refused(box.run("query s.csv p.csv --domain 0 1 0 1 0"), "--domain");
    check_refused(box.run("query --domain 0 1 0 1 s.csv p.csv"), "--domain");
}

TEST_CASE("a file of an unknown ending is refused with all that can be read") {
    const Sandbox box("unknown-ending");
    box.write("a.xyz", "0 0 0 1\n");
    const Outcome outcome = box.run("info a.xyz");
    check_refused(outcome, "a.xyz: its ending is none that can be read: name a .csv, .npy, .mesh");
    for (const char* ending : {".vtu", ".vtk", ".vdb", ".stl", ".step", ".msh", ".pos", ".solb"}) {
        CHECK_THAT(outcome.err, Contains(ending));
    }
}

}  // namespace controlspace::sources_test
