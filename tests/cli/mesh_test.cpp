// SPDX-License-Identifier: Apache-2.0
// End to end: `controlspace mesh`.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/sandbox.h"
#include "data_folder.h"

namespace controlspace::mesh_test {

using Catch::Matchers::Contains;

namespace {

/// The sphere at lengths of 0.2: some thousand tetrahedra.
const std::string coarse = "mesh --h 0.1 --probe-grid 10 --output out ";

const std::string thin = "--s-a 4 --s-n 0.25 ";

}  // namespace

TEST_CASE("one command makes meshes, and says how they conform") {
    const Sandbox box("mesh");
    const Outcome outcome = box.run(coarse + "--structures K_oV,uniform-trilinear");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(lines(outcome.err) == 3);
    CHECK_THAT(outcome.out, Contains("exact") && Contains("K_oV") && Contains("L_R") &&
                                Contains("Meshes: delaunay") && Contains("Meshes: out"));
    for (const char* name : {"00-exact", "01-K_oV", "02-uniform-trilinear"}) {
        for (const char* ending : {".msh", ".mesh", ".sol", ".vtu"}) {
            CHECK(fs::file_size(box / "out" / (std::string(name) + ending)) > 1000);
        }
    }
    const auto json = nlohmann::json::parse(file_text(box / "out" / "meshes.json"));
    CHECK(json["complete"] == true);
    REQUIRE(json["rows"].size() == 3);
    for (const auto& row : json["rows"]) {
        INFO(row.dump());
        CHECK(row["tets"] > 1000);
        // As many edges conform as with the exact field, but for what meshers scatter: 0.02 here.
        CHECK(row["L_R"] > json["rows"][0]["L_R"].get<double>() - 0.05);
        CHECK(row["unit_share"] > row["L_R"]);
        CHECK(row["queries"] > row["nodes"].get<int>() / 4);
        CHECK(row["query_s"] < row["mesh_s"]);
        CHECK(row["peak_bytes"] > 1e6);
    }
}

TEST_CASE("a part is meshed, by its own field or another's") {
    const Sandbox box("mesh-part");
    // A brick of 2 x 1 x 1.
    box.write("brick.off",
              "OFF\n8 6 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n0 0 1\n2 0 1\n2 1 1\n0 1 1\n"
              "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
    const std::string quick =
        "--exact no --probe-grid 5 --files mesh --optimize 0 --mesher delaunay ";
    const auto meshed = [&](const std::string& arguments) {
        const Outcome outcome = box.run("mesh " + arguments + " " + quick);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
    };
    // Of the vertices of the mesh: whether all lie in the brick.
    const auto is_brick = [&](const std::string& folder) {
        std::istringstream text(file_text(box / folder / "00-K_oV.mesh"));
        for (std::string word; text >> word && word != "Vertices";) {
        }
        std::size_t n = 0;
        text >> n;
        bool inside = n > 8;
        for (double x, y, z, label; n > 0 && text >> x >> y >> z >> label; --n) {
            inside = inside && x > -1e-6 && x < 2 + 1e-6 && y > -1e-6 && y < 1 + 1e-6 &&
                     z > -1e-6 && z < 1 + 1e-6;
        }
        return inside && n == 0;
    };
    meshed("brick.off --isotropic --output own");
    CHECK(is_brick("own"));
    box.write("s.csv", "x,y,z,h\n1,0.5,0.5,0.1\n-1,-1,-1,0.5\n3,3,3,0.5\n");
    meshed("s.csv --part brick.off --output other");
    CHECK(is_brick("other"));
    meshed("s.csv --output domain");
    CHECK_FALSE(is_brick("domain"));
    check_refused(box.run("mesh s.csv --part none.off"), "none.off");
    check_refused(box.run("mesh s.csv --part s.csv"), "s.csv is no part: name a .stl");
    box.write("far.csv", "x,y,z,h\n5,5,5,0.1\n6,6,6,0.1\n");
    CHECK_THAT(
        box.run("mesh far.csv --part brick.off --domain 5,6,5,6,5,6 --output far " + quick).err,
        Contains("is not inside of the field's domain"));
    // A domain that nobody chose grows to the part.
    const Outcome grown = box.run("mesh far.csv --part brick.off --output grown " + quick);
    CHECK(grown.status == 0);
    CHECK_THAT(grown.err,
               Contains("grows to the part: [0, 6.05] x [0, 6.05] x [0, 6.05] (--domain"));
    CHECK(is_brick("grown"));
    box.write("open.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 1 2 3\n");
    check_refused(box.run("mesh open.off --isotropic --output open"),
                  "open.off: 3 of 6 edges are open");
    CHECK_FALSE(fs::exists(box / "open"));
}

TEST_CASE("a CAD file in metres says so, and is converted into the unit of the field") {
    const Sandbox box("mesh-unit");
    fs::copy(data_folder().parent_path() / "tests" / "data" / "cyl_m.step", box / "c.step");
    box.write("p.csv", "x,y,z\n5,0,10\n");
    const auto extent = [&](const std::string& options, const std::string& warning) {
        const Outcome outcome = box.run("info c.step " + options);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK(outcome.err.empty() == warning.empty());
        CHECK_THAT(outcome.err, Contains(warning));
        const std::size_t at = outcome.out.find("extent");
        return outcome.out.substr(at, outcome.out.find('\n', at) - at) +
               outcome.out.substr(outcome.out.find("\n  unit"), 40);
    };
    // A cylinder of radius 5 m and height 20 m.
    CHECK_THAT(extent("",
                      "c.step has the unit m, and is converted into mm: give that of the field "
                      "(--unit m)"),
               Contains("[-5000, 5000] x [-5000, 5000] x [0, 20000]") &&
                   Contains("m in the file, mm here"));
    CHECK_THAT(extent("--unit m", ""),
               Contains("[-5, 5] x [-5, 5] x [0, 20]") && Contains("m in the file, m here"));
    CHECK_THAT(extent("--unit cm --scale 0.5", ""), Contains("[-250, 250] x [-250, 250] x [0, 10"));
    // The chord of 15 degrees, from where lengths grow; bounds are in the unit of the field.
    const auto length = [&](const std::string& options) {
        const Outcome outcome =
            box.run("query c.step p.csv --unit m --isotropic --structures direct " + options);
        INFO(outcome.err);
        REQUIRE(outcome.status == 0);
        return std::stod(outcome.out.substr(outcome.out.rfind(',') + 1));
    };
    const double chord = 10 * std::sin(7.5 * M_PI / 180);
    CHECK((length("") > chord && length("") < 1.25 * chord));
    const double raised = length("--surface-h-min 2");
    CHECK((raised > 2 && raised < 2.5));
    const Outcome mesh = box.run(
        "mesh c.step --unit m --isotropic --exact no --probe-grid 3 --files mesh --optimize 0 "
        "--mesher delaunay --output m");
    INFO(mesh.err);
    CHECK(mesh.status == 0);
    CHECK_THAT(file_text(box / "m" / "00-K_oV.mesh"), Contains("\n5 ") && !Contains("\n5000"));
}

TEST_CASE("points are scaled with their lengths") {
    const Sandbox box("scale");
    box.write("p.csv", "x,y,z,h\n0,0,0,0.5\n1,2,3,0.25\n");
    REQUIRE(box.run("convert p.csv q.csv --scale 10").status == 0);
    CHECK(file_text(box / "q.csv") == "x,y,z,h\n0,0,0,5\n10,20,30,2.5\n");
    check_refused(box.run("info sphere --scale 10"), "scale is for files of sources");
    check_refused(box.run("info p.csv --unit yd"), "--unit");
}

TEST_CASE("Gmsh has a limit of time, and its crash is a row with its last words") {
    const Sandbox box("mesh-apart");
    const Outcome late = box.run(
        "mesh --h 0.02 --probe-grid 5 --structures K_oL --mesher delaunay --exact no --files none "
        "--time-limit 0.01 --output late");
    CHECK(late.status == 3);
    CHECK_THAT(late.err, Contains("Gmsh took longer than 0.01 s (--time-limit)"));
    CHECK(std::distance(fs::directory_iterator(box / "late"), {}) == 1);  // no file of the child

    // Triangles whose edges Gmsh 4.8 cannot recover: it throws where nobody catches.
    fs::copy_file(data_folder() / "../tests/data/bipyramid-of-ten.stl", box / "part.stl");
    const Outcome crashed = box.run(
        "mesh part.stl --isotropic --probe-grid 5 --exact no --files none --output crashed");
    INFO(crashed.err);
    CHECK((crashed.status == 0 || crashed.status == 3));
    if (crashed.status == 3) {
        CHECK_THAT(crashed.err, Contains("Gmsh ") && Contains("repair the part"));
    }
}

TEST_CASE("a target that a meshed structure missed is told, with status 3") {
    const Sandbox box("mesh-missed");
    const Outcome outcome = box.run(
        "mesh --h 0.1 --probe-grid 5 --structures K_oL --target-delta 0.001 --octree-depth 2 "
        "--exact no --files none --output out");
    INFO(outcome.err);
    CHECK(outcome.status == 3);
    CHECK_THAT(outcome.err, Contains("warning: K_oL") && Contains("target 0.001 ("));
    const auto json = nlohmann::json::parse(file_text(box / "out" / "meshes.json"));
    REQUIRE(json["rows"].size() == 1);
    CHECK(json["rows"][0]["error"] == "");
    CHECK_THAT(json["rows"][0]["shortfall"].get<std::string>(), Contains("target"));
}

TEST_CASE("a study's cases are meshed as its options say") {
    const Sandbox box("mesh-study");
    box.write("s.csv", "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n");
    box.write("study.toml",
              "sources = 's.csv'\nprobe_grid = 5\n[[runs]]\nstructures = 'K_L'\nsplits = 's_L'\n"
              "tau = [1, 0.5]\n");
    const Outcome outcome = box.run(
        "mesh study.toml --mesher hxt --files none --exact no --quiet --factor 0.8 --output out");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(outcome.err.empty());
    CHECK_THAT(outcome.out, !Contains("exact ") || Contains("K_L s_L"));
    CHECK(std::distance(fs::directory_iterator(box / "out"), fs::directory_iterator()) == 1);
    const auto json = nlohmann::json::parse(file_text(box / "out" / "meshes.json"));
    REQUIRE(json["rows"].size() == 2);
    CHECK(json["rows"][1]["mesher"] == "hxt");
    CHECK(json["settings"]["factor"] == "0.8");
}

TEST_CASE("a saved control space is meshed as it is") {
    const Sandbox box("mesh-saved");
    REQUIRE(box.run("build --h 0.1 --structures K_oV -o f.ctrl").status == 0);
    const Outcome outcome = box.run("mesh f.ctrl --output out --files vtu");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(lines(outcome.err) == 1);
    CHECK_THAT(outcome.out, Contains("Meshes: delaunay, f.ctrl") && Contains("K_oV") &&
                                !Contains("\nexact ") && !Contains("Table 5"));
    CHECK(fs::file_size(box / "out" / "00-K_oV.vtu") > 1000);
    const auto json = nlohmann::json::parse(file_text(box / "out" / "meshes.json"));
    REQUIRE(json["rows"].size() == 1);
    const auto& row = json["rows"][0];
    CHECK(row["field"] == "K_oV");
    CHECK(row["setting"] == "f.ctrl");
    CHECK(row["L_R"] > 0.5);
    CHECK_FALSE(row.contains("delta_R_max"));
    // The same mesh as of the structure before it was saved.
    REQUIRE(box.run("mesh --h 0.1 --probe-grid 10 --structures K_oV --exact no --files none "
                    "--quiet --output made")
                .status == 0);
    const auto made = nlohmann::json::parse(file_text(box / "made" / "meshes.json"));
    CHECK(made["rows"][0]["tets"] == row["tets"]);

    check_refused(box.run("mesh f.ctrl --output no --tau 0.5"), "--tau: f.ctrl was made with");
    check_refused(box.run("mesh none.ctrl --output no"), "none.ctrl");
    box.write("text.ctrl", "x,y,z,h\n");
    check_refused(box.run("mesh text.ctrl --output no"), "is no control space");
    CHECK_FALSE(fs::exists(box / "no"));
}

TEST_CASE("Gmsh on an anisotropic field warns and goes on") {
    const Sandbox box("mesh-warning");
    const Outcome outcome =
        box.run(coarse + "--s-n 0.8 --mesher delaunay --exact no --files none --quiet");
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(lines(outcome.err) == 1);
    CHECK_THAT(outcome.err, Contains("anisotropic") && Contains("--mesher mmg"));
}

TEST_CASE("a mesher that fails makes a row with its reason, and status 3") {
    const Sandbox box("mesh-failed");
    box.write("mmg", "#!/bin/sh\necho not SPD\nexit 1\n");
    fs::permissions(box / "mmg", fs::perms::owner_all);
    const Outcome outcome = box.run(coarse + thin + "--mmg ./mmg --files none --quiet");
    INFO(outcome.err);
    CHECK(outcome.status == 3);
    CHECK_THAT(outcome.err, Contains("MMG failed with status 1: not SPD (its files: "));
    CHECK_THAT(outcome.out, Contains("failed: MMG failed"));
    const auto json = nlohmann::json::parse(file_text(box / "out" / "meshes.json"));
    CHECK(json["rows"].size() == 2);
}

TEST_CASE("what cannot be meshed ends with one line, and leaves no folder") {
    const Sandbox box("mesh-refused");
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"--mesher netgen", "--mesher: unknown value 'netgen'"},
        {"--start fine", "--start: unknown value 'fine': give coarse, delaunay, hxt"},
        {"--factor 0", "--factor: 0 is not positive"},
        {"--optimize 1", "--optimize: 1 is out of range"},
        {"--files stl", "--files: unknown kind of file 'stl'"},
        {"--files msh,none", "--files: unknown kind of file 'none'"},
        {"--rounds 0", "--rounds"},
        {"--time-limit 0", "--time-limit"},
        {"--exact maybe", "--exact: unknown value 'maybe': give yes, no"},
        {"--mesh-threads 0", "--mesh-threads"},
        {"--structures uniform-nearest --equal-delta 0.1", "equal_delta"},
        {"--kd-depth 1000 --structures K_L", "depth"},
        {"--structures K_X", "unknown structure 'K_X'"},
        {"--access-points 3", "--access-points"},
        {"no.toml", "no.toml"},
        {"no.csv", "sampled surfaces"},
        {"--s-n 0.25 --mmg ./none", "./none: no program"},
        {"--s-n 0.25", "MMG is missing"},
    }));
    INFO(arguments);
    check_refused(box.run(coarse + arguments, "export PATH=/nowhere; "), expected);
    CHECK_FALSE(fs::exists(box / "out"));
}

TEST_CASE("Ctrl-C in the midst of a mesh leaves whole files and status 130") {
    const Sandbox box("mesh-interrupt");
    // A million tetrahedra, so that the signal comes before they are made.
    const Outcome outcome =
        box.run("mesh --h 0.01 --probe-grid 5 --output out",
                "(for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do sleep 0.5; "
                "[ -e out/meshes.json ] && break; done; kill -INT $(cat pid)) & "
                "exec sh -c 'echo $$ >pid; exec \"$@\"' sh ");
    INFO(outcome.err);
    CHECK(outcome.status == 130);
    CHECK_THAT(outcome.err, Contains("interrupted: meshes in out: 0"));
    const auto json = nlohmann::json::parse(file_text(box / "out" / "meshes.json"));
    CHECK(json["complete"] == false);
    CHECK(std::distance(fs::directory_iterator(box / "out"), fs::directory_iterator()) == 1);
}

}  // namespace controlspace::mesh_test
