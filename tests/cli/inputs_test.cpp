// SPDX-License-Identifier: Apache-2.0
// What all commands have in common: INPUT, --output, --quiet and the help.
#include <catch2/catch.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/sandbox.h"
#include "cli/terminal.h"

namespace controlspace::inputs_test {

using Catch::Matchers::Contains;

namespace {

const std::string sources_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";
const std::vector<std::string> commands{"compare", "info",   "convert", "build",
                                        "query",   "export", "mesh",    "list"};

}  // namespace

TEST_CASE("INPUT is a file, or any other value of --sources") {
    const Sandbox box("inputs");
    box.write("a.csv", sources_csv);
    box.write("b.csv", "x,y,z,h\n2,0,0,0.05\n");
    const auto [input, sources] = GENERATE(table<std::string, std::string>(
        {{"planes", "planes"}, {"a.csv,b.csv", "a.csv,b.csv"}, {"sphere", "sphere"}}));
    const std::string field = " --h 0.2";
    const std::string more = input == "a.csv,b.csv" ? "" : field;
    REQUIRE(box.run("export " + input + more + " -o by-name.csv").status == 0);
    REQUIRE(box.run("export --sources " + sources + more + " -o by-option.csv").status == 0);
    CHECK(file_text(box / "by-name.csv") == file_text(box / "by-option.csv"));
    const Outcome info = box.run("info " + input);
    INFO(info.err);
    CHECK(info.status == 0);
    CHECK_THAT(info.out, Contains("all positive definite"));
    CHECK(box.run("convert " + input + " all.csv").status == 0);
    CHECK(lines(file_text(box / "all.csv")) > 5);
}

TEST_CASE("files come before names, and a study compares any INPUT") {
    const Sandbox box("inputs-first");
    box.write("sphere", sources_csv);
    // A file without an ending has no format.
    check_refused(box.run("info sphere"), "sphere");
    box.write("s.csv", sources_csv);
    const std::string quick =
        " --structures K_oL --access-points 100 --access-repeats 3 "
        "--probe-grid 5 --fine-probe-grid 5 --creation-repeats 1";
    const Outcome outcome = box.run("compare s.csv -o out --quiet" + quick);
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    CHECK_THAT(file_text(box / "out" / "results.json"), Contains("\"name\": \"s\""));
}

TEST_CASE("an INPUT that is nothing is refused by one line that lists what would do") {
    const Sandbox box("inputs-refused");
    const std::string command =
        GENERATE("build spere -o f.ctrl", "export spere -o f.csv", "info spere",
                 "convert spere a.csv", "compare spere", "query spere a.csv --pipe");
    box.write("p.csv", "x,y,z\n0,0,0\n");
    if (command.starts_with("query")) {
        check_refused(box.run("query spere p.csv"), "sphere, planes, none");
    } else {
        check_refused(box.run(command), "there is no file 'spere'");
    }
}

TEST_CASE("all commands take --quiet, and -o for what they write") {
    const Sandbox box("outputs");
    for (const std::string& command : commands) {
        INFO(command);
        const Outcome help = box.run(command + " --help");
        CHECK(help.status == 0);
        CHECK_THAT(help.out, Contains("\n  --quiet ") && Contains("\n  -o,--output "));
    }
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("convert s.csv -o t.csv --quiet").status == 0);
    CHECK(file_text(box / "t.csv") == file_text(box / "s.csv"));
    check_refused(box.run("convert s.csv t.csv -o u.csv"), "excludes");
    check_refused(box.run("convert s.csv"), "no OUT");
    const Outcome info = box.run("info s.csv --quiet");
    REQUIRE(box.run("info s.csv -o info.txt").out.empty());
    CHECK(file_text(box / "info.txt") == info.out);
    check_refused(box.run("info s.csv -o s.csv"), "s.csv is read");
    REQUIRE(box.run("list -o list.txt").status == 0);
    CHECK(file_text(box / "list.txt") == box.run("list").out);
}

TEST_CASE("the help has the user's options first, the paper's last, and fits 80 columns") {
    const Sandbox box("help-topics");
    for (const std::string& command : commands) {
        const std::string help = box.run(command + " --help").out;
        std::istringstream in(help);
        for (std::string line; std::getline(in, line);) {
            INFO(command << ": " << line);
            const auto columns = std::count_if(line.begin(), line.end(),
                                               [](char c) { return (c & '\xc0') != '\x80'; });
            CHECK(columns <= 80);
        }
    }
    const std::string help = box.run("compare --help").out;
    std::size_t last = 0;
    for (const char* title : {"\nOptions:", "\nSources:", "\nThe paper's samples and schemes:",
                              "\nExamples:", "\nExit status:"}) {
        const std::size_t at = help.find(title);
        INFO(title);
        REQUIRE(at != help.npos);
        CHECK(at > last);
        last = at;
    }
}

TEST_CASE("an option has one range, whoever checks it") {
    const Sandbox box("ranges");
    for (const char* depth : {"-1", "61", "1000"}) {
        check_refused(box.run(std::string("build -o f.ctrl --octree-depth ") + depth),
                      "--octree-depth: " + std::string(depth) + " is out of range: give 0 to 60");
    }
    check_refused(box.run("build -o f.ctrl --structures K_L --kd-depth 201"), "give 0 to 200");
}

}  // namespace controlspace::inputs_test
