// SPDX-License-Identifier: Apache-2.0
// End to end: `controlspace export`.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/sandbox.h"

namespace controlspace::export_test {

using Catch::Matchers::Contains;

namespace {

const std::string sources_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";

}  // namespace

TEST_CASE("one command exports the paper's sphere") {
    const Sandbox box("export");
    const Outcome outcome = box.run("export -o sphere.vdb --voxel 0.04");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, Contains("sphere.vdb: 50 x 50 x 50 voxels of 0.04"));
    // Its smallest length is 0.03: a warning; and how it was made.
    CHECK_THAT(outcome.err, Contains("--voxel") && Contains("lengths within 1.1x"));
    CHECK(lines(outcome.err) == 2);
    CHECK(fs::file_size(box / "sphere.vdb") > 10000);
}

TEST_CASE("sources or a study, and any structure") {
    const Sandbox box("export-inputs");
    box.write("s.csv", sources_csv);
    box.write("study.toml", "sources = 's.csv'\nstructures = 'K_L'\nsplits = 's_M'\n");
    for (const char* arguments :
         {"s.csv --structures K_V --splits s_G", "s.csv --structures direct --g-r 1.5",
          "study.toml", "study.toml --structures K_oL,K_oL --law mean-length",
          "--sources s.csv --half --compression zip --grids h_min,sources"}) {
        INFO(arguments);
        const Outcome outcome = box.run(std::string("export -o out.vdb --voxel 0.05 ") + arguments);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK_THAT(outcome.err, !Contains("warning"));
        REQUIRE(fs::remove(box / "out.vdb"));
    }
}

TEST_CASE("an export that cannot be made ends with one line, and leaves no file") {
    const Sandbox box("export-refused");
    box.write("s.csv", sources_csv);
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"", "--output"},
        {"-o out.vdb --structures K_L,K_oL", "2 cases"},
        {"-o out.vdb --structures K_L --splits s_L,s_G", "choose one by --structures"},
        {"-o out.vdb s.csv --tau 1,0.5", "2 cases"},
        {"-o out.vdb s.csv --structures uniform-nearest --equal-delta 0.1", "give the voxel"},
        {"-o out.vdb --structures K_X", "K_X"},
        {"-o out.vdb no.csv", "no.csv"},
        {"-o out.vdb no.toml", "no.toml"},
        {"-o out.vdb s.csv --grids h_min,speed", "unknown grid 'speed'"},
        {"-o out.vdb s.csv --compression lzma", "lzma"},
        {"-o out.vdb s.csv --voxel -1", "positive"},
        {"-o out.vdb s.csv --voxel 1e-9", "--voxel"},
        {"-o out.vdb s.csv --tolerance -1", "tolerance"},
        {"-o out.vdb s.csv --access-points 3", "--access-points"},
        {"-o none/out.vdb s.csv", "none/out.vdb"},
        {"-o . s.csv", ".: name a file of one of .csv"},
        {"-o /dev/full s.csv", "/dev/full"},
        {"-o out.vdb s.csv --samples 5", "--samples is for .structured, .msh, .vti, .npy and .nc"},
        {"-o out.vtu s.csv --voxel 0.1", "--voxel is for .vdb"},
        // Before anything is read.
        {"-o out.vti no.csv --samples 1", "1 samples: give 2 to 8192"},
        {"-o out.vti no.csv --slice w", "'w' is no axis"},
        {"-o /proc/out.vdb s.csv", "/proc/out.vdb"},
    }));
    INFO(arguments);
    check_refused(box.run("export " + arguments), expected);
    CHECK_FALSE(fs::exists(box / "out.vdb"));
}

TEST_CASE("an exported field is a field, and its fog a surface, of another study") {
    const Sandbox box("import");
    REQUIRE(
        box.run("export -o out.vdb --h 0.05 --voxel 0.05 --tolerance 0 --structures K_oV").status ==
        0);
    const std::string compare =
        "compare --structures uniform-trilinear --access-points 100 --access-repeats 3 "
        "--probe-grid 20 --fine-probe-grid 6 --output ";
    const auto row = [&](const std::string& folder) {
        const auto json = nlohmann::json::parse(file_text(box / folder / "results.json"));
        REQUIRE(json["rows"].size() == 1);
        CHECK(json["rows"][0]["error"] == "");
        return json;
    };

    // Voxels' centres are the cells' centres of the grid: what lies between is linear in both.
    const Outcome field =
        box.run(compare + "field --sources none --field file --field-file out.vdb --voxel 0.05");
    INFO(field.err);
    REQUIRE(field.status == 0);
    CHECK(row("field")["rows"][0]["delta_R_max"] < 0.2);
    CHECK(row("field")["settings"]["field_file"] == "out.vdb");

    const Outcome painted =
        box.run(compare +
                "painted --sources none --field file --field-file out.vdb --field-grid density "
                "--field-density-sizes 0.1,0.5 --voxel 0.1");
    INFO(painted.err);
    CHECK(painted.status == 0);

    const Outcome surface =
        box.run(compare + "surface --sources out.vdb --vdb-grid density --vdb-size 0.1");
    INFO(surface.err);
    REQUIRE(surface.status == 0);
    CHECK(row("surface")["rows"][0]["sources"] > 1000);

    // A study file names them from where it lies.
    fs::create_directory(box / "studies");
    fs::rename(box / "out.vdb", box / "studies" / "out.vdb");
    box.write("studies/study.toml",
              "sources = 'none'\nfield = 'file'\nfield_file = 'out.vdb'\n"
              "structures = 'uniform-nearest'\nvoxel = 0.1\n");
    CHECK(box.run("export studies/study.toml -o again.vdb").status == 0);
}

TEST_CASE(".vdb files that cannot be used end with one line") {
    const Sandbox box("import-refused");
    box.write("s.csv", sources_csv);
    box.write("text.vdb", "not a volume at all");
    REQUIRE(box.run("export s.csv -o out.vdb --voxel 0.2 --grids h_min,density").status == 0);
    REQUIRE(box.run("export s.csv -o density.vdb --voxel 0.2 --grids density").status == 0);
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"--sources none.vdb --vdb-size 1", "none.vdb"},
        {"--sources text.vdb --vdb-size 1", "text.vdb"},
        {"--sources out.vdb", "length"},
        {"--sources out.vdb --vdb-size 1", "density (float), h_min (float)"},
        {"--sources out.vdb --vdb-size 1 --vdb-grid h_min", "isovalue"},
        {"--sources out.vdb --vdb-size 0 --vdb-grid density",
         "give a positive length (--vdb-size)"},
        {"--sources s.csv --vdb-size 1", "vdb_size"},
        {"--sources none --field file", "field_file"},
        {"--sources none --field sphere --field-file out.vdb", "field_file"},
        {"--sources none --field file --field-file density.vdb", "metric_diag"},
        {"--sources none --field file --field-file no.vdb", "no.vdb"},
        {"--sources none --field file --field-file out.vdb --field-grid speed", "no grid 'speed'"},
    }));
    INFO(arguments);
    check_refused(box.run("compare --structures uniform-nearest " + arguments), expected);
}

}  // namespace controlspace::export_test
