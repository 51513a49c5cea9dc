// End to end: `controlspace build`, and what takes what it saves.
#include <catch2/catch.hpp>

#include "app/sandbox.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

const std::string sources_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";
const std::string places_csv = "x,y,z\n0,0,0\n0.3,0.4,0.5\n0.9,0.1,0.7\n";

}  // namespace

TEST_CASE("what is queried of a saved control space is what was queried before it was saved") {
    const Sandbox box("build");
    box.write("s.csv", sources_csv);
    box.write("places.csv", places_csv);
    const std::string structure = GENERATE("K_V", "K_oLA", "uniform-trilinear");
    CAPTURE(structure);
    const Outcome built = box.run("build s.csv -o f.ctrl --structures " + structure);
    INFO(built.err);
    REQUIRE(built.status == 0);
    CHECK_THAT(built.out, Contains("f.ctrl: " + structure + " with"));
    const Outcome made = box.run("query s.csv places.csv --structures " + structure);
    const Outcome loaded = box.run("query f.ctrl places.csv");
    INFO(loaded.err);
    CHECK(loaded.status == 0);
    CHECK(loaded.out == made.out);
    CHECK(lines(loaded.out) == 4);
}

TEST_CASE("saved control spaces that cannot be used") {
    const Sandbox box("build-bad");
    box.write("s.csv", sources_csv);
    box.write("places.csv", places_csv);
    check_refused(box.run("build s.csv -o f.txt"), "ends in .ctrl");
    check_refused(box.run("build s.csv -o f.ctrl --structures K_L,K_V"), "only one can be taken");
    CHECK(!fs::exists(box / "f.ctrl"));
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    check_refused(box.run("query f.ctrl places.csv --tau 0.5"), "--tau");
    box.write("cut.ctrl", file_text(box / "f.ctrl").substr(0, 200));
    check_refused(box.run("query cut.ctrl places.csv"), "is truncated");
    box.write("text.ctrl", sources_csv);
    check_refused(box.run("query text.ctrl places.csv"), "is no control space");
}
