// SPDX-License-Identifier: Apache-2.0
// End to end: what runs show while they go on, on a terminal and elsewhere, and what Ctrl-C leaves.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "cli/terminal.h"

namespace controlspace::progress_test {

using Catch::Matchers::Contains;

namespace {

/// Of the two cases one takes no time, the other seconds.
const std::string study =
    "access_points = 100\naccess_repeats = 1\nfine_probe_grid = 9\nstructures = 'K_oV'\n"
    "[[runs]]\nrho = 4\ntau = 2\n[[runs]]\nrho = 0.4\ntau = 0.5\n";

nlohmann::json results(const Sandbox& box, const std::string& folder) {
    return nlohmann::json::parse(file_text(box / folder / "results.json"));
}

/// A row without what hangs on the clock.
nlohmann::json without_times(nlohmann::json row) {
    for (auto field = row.begin(); field != row.end();) {
        field = field.key().starts_with("t_") ? row.erase(field) : std::next(field);
    }
    REQUIRE(row.contains("delta_R_max"));
    return row;
}

}  // namespace

TEST_CASE("a terminal shows a study's rate and time left, and Ctrl-C leaves what --resume ends") {
    const Sandbox box("terminal-study");
    box.write("study.toml", study);
    const Outcome stopped = run_on_terminal(box, "compare study.toml --output out", "left");
    INFO(stopped.err);
    CHECK(stopped.status == 130);
    CHECK_THAT(stopped.err,
               Contains("case 2/2  K_oV") && Contains(" cases/s, about ") && Contains("\r\033[K") &&
                   Contains("interrupted: 1 of 2 cases done, in out; to continue, run the "
                            "same command with --resume out"));
    REQUIRE(results(box, "out")["rows"].size() == 1);
    CHECK(results(box, "out")["complete"] == false);

    const Outcome resumed = run_on_terminal(box, "compare study.toml --resume out");
    INFO(resumed.err);
    REQUIRE(resumed.status == 0);
    // The line is gone in the end.
    CHECK(resumed.err.substr(resumed.err.rfind('\r')) == "\r\033[K");
    REQUIRE(box.run("compare study.toml --quiet --output whole").status == 0);
    const auto whole = results(box, "whole");
    const auto joined = results(box, "out");
    CHECK(joined["complete"] == true);
    REQUIRE(joined["rows"].size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(without_times(joined["rows"][i]) == without_times(whole["rows"][i]));
    }
}

TEST_CASE(
    "a quiet study shows nothing on a terminal, and without one there is a line for each case",
    "[threads]") {
    const Sandbox box("terminal-quiet");
    const std::string compare =
        "compare --h 0.3 --structures K_oL,K_oV --law cone --access-points 100 --access-repeats 1 "
        "--fine-probe-grid 9 ";
    const Outcome quiet = run_on_terminal(box, compare + "--quiet --output quiet");
    CHECK(quiet.status == 0);
    CHECK(quiet.err.empty());
    const Outcome elsewhere = box.run(compare + "--output out");
    CHECK(lines(elsewhere.err) == 2);
    CHECK(elsewhere.err.find_first_of("\r\033") == std::string::npos);
}

#ifdef CONTROLSPACE_OPENVDB
TEST_CASE("a terminal shows how far a file has come, and Ctrl-C leaves nothing of it",
          "[threads]") {
    const Sandbox box("terminal-file");
    box.write("s.csv", "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n");
    const std::string arguments =
        "export s.csv -o out.vdb --structures K_oV --voxel 0.002 --tolerance 0";
    const Outcome stopped = run_on_terminal(box, arguments, "left");
    INFO(stopped.err);
    CHECK(stopped.status == 130);
    CHECK_THAT(stopped.err, Contains(" million voxels, ") && Contains(" million/s, about ") &&
                                Contains("interrupted: nothing was written"));
    CHECK(std::distance(fs::directory_iterator(box / ""), fs::directory_iterator()) == 2);
}
#endif

}  // namespace controlspace::progress_test
