// End to end: `controlspace export`.
#include <catch2/catch.hpp>
#include <string>

#include "app/sandbox.h"

using namespace controlspace;
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
    // Its smallest length is 0.03: a warning, one line.
    CHECK_THAT(outcome.err, Contains("--voxel"));
    CHECK(lines(outcome.err) == 1);
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
        CHECK(outcome.err.empty());
        REQUIRE(fs::remove(box / "out.vdb"));
    }
}

TEST_CASE("an export that cannot be made ends with one line, and leaves no file") {
    const Sandbox box("export-refused");
    box.write("s.csv", sources_csv);
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"", "--output"},
        {"-o out.vdb --structures K_L,K_oL", "2 cases"},
        {"-o out.vdb --structures K_L --splits s_L,s_G", "a file takes one"},
        {"-o out.vdb s.csv --tau 1,0.5", "2 cases"},
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
        {"-o . s.csv", "directory"},
        {"-o /dev/full s.csv", "/dev/full"},
        {"-o /proc/out.vdb s.csv", "/proc/out.vdb"},
    }));
    INFO(arguments);
    check_refused(box.run("export " + arguments), expected);
    CHECK_FALSE(fs::exists(box / "out.vdb"));
}
