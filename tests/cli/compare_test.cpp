// SPDX-License-Identifier: Apache-2.0
// End to end: runs the program as a user does.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/sandbox.h"

namespace controlspace::compare_test {

using Catch::Matchers::Contains;

namespace {

/// A few sources that ask for two sizes.
const std::string sources_csv =
    "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n0,0,1,0.2\n1,1,1,0.4\n0.5,0.5,0.5,0.3\n";

/// Settings that make any study short.
const std::string quick =
    " --access-points 100 --access-repeats 3 --probe-grid 5 --fine-probe-grid 6 ";

}  // namespace

TEST_CASE("all structures are compared on sources from a file", "[threads]") {
    const Sandbox box("compare");
    box.write("s.csv", sources_csv);
    const Outcome outcome = box.run("compare --sources s.csv --output out" + quick);
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, Contains("Results: out"));
    for (const char* file : {"results.json", "results.csv"}) {
        CHECK(fs::file_size(box / "out" / file) > 0);
    }
    const auto json = nlohmann::json::parse(file_text(box / "out" / "results.json"));
    CHECK(json["complete"] == true);
    CHECK(json["rows"].size() >= 3 * 3 + 3 + 2);
    for (const auto& row : json["rows"]) {
        INFO(row.dump());
        CHECK(row["error"] == "");
        CHECK(row["sources"] == 6);
        CHECK(row["rho"].is_null());
        CHECK(row["gradation_max_left"] <= 1.2501);
    }
    // It ends with which structure to take, in the words of the results.
    REQUIRE(json["outcomes"].size() == 1);
    std::string words = "\nWhich structure to take\n";
    for (const auto& sentence : json["outcomes"][0]["sentences"]) {
        words.append(sentence.get<std::string>()).append("\n");
    }
    CHECK_THAT(outcome.out, Contains(words + "\nResults: out"));
    // One line of progress for each case, as standard error is no terminal.
    CHECK(lines(outcome.err) == json["rows"].size());
}

TEST_CASE("rows of a file are limited unless told otherwise, those of a study are not") {
    const Sandbox box("limits");
    box.write("s.csv", sources_csv);
    box.write("study.toml", "sources = 's.csv'\nstructures = 'K_oL'\n");
    const auto settings = [&](const std::string& arguments, const std::string& folder) {
        REQUIRE(box.run("compare " + arguments + " --quiet --output " + folder + quick).status ==
                0);
        return nlohmann::json::parse(file_text(box / folder / "results.json"))["settings"];
    };
    const auto of_file = settings("s.csv --structures K_oL", "a");
    CHECK(of_file["max_seconds"] == 60);
    CHECK(of_file["max_memory_ratio"] == 20);
    const auto told = settings("s.csv --structures K_oL --max-seconds 0 --max-memory-ratio 5", "b");
    CHECK(told["max_seconds"].is_null());
    CHECK(told["max_memory_ratio"] == 5);
    const auto of_study = settings("study.toml", "c");
    CHECK(of_study["max_seconds"].is_null());
    CHECK(of_study["max_memory_ratio"].is_null());
}

#ifdef CONTROLSPACE_OPENVDB
TEST_CASE("tensors are compared in OpenVDB's rows too") {
    const Sandbox box("tensors");
    box.write("s.csv",
              "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n0,0,0,0.1,0.2,0.2,0,0,0\n1,1,1,0.4,0.3,0.3,0."
              "05,0,0\n");
    const Outcome outcome = box.run("compare s.csv --output out" + quick);
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    const auto json = nlohmann::json::parse(file_text(box / "out" / "results.json"));
    std::size_t rows = 0;
    for (const auto& row : json["rows"]) {
        if (!row["structure"].get<std::string>().starts_with("openvdb")) continue;
        INFO(row.dump());
        CHECK(row["error"] == "");
        CHECK(row["answers"] == "metrics");
        ++rows;
    }
    CHECK(rows >= 3);
}
#endif

TEST_CASE("options override the study file, and quiet is quiet") {
    const Sandbox box("override");
    box.write("s.csv", sources_csv);
    box.write("study.toml",
              "name = 'mine'\nsources = 's.csv'\nstructures = 'K_L'\nsplits = 's_L'\n"
              "access_points = 100\nprobe_grid = 5\nfine_probe_grid = 5\n[[runs]]\ntau = [2, 1]\n");
    const Outcome outcome =
        box.run("compare study.toml --tau 1,0.5,0.25 --structures K_oL,K_L --g-r 1.5 --quiet");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(outcome.err.empty());
    REQUIRE(fs::exists(box / "results"));
    const fs::path folder = fs::directory_iterator(box / "results")->path();
    CHECK_THAT(folder.filename().string(), Catch::Matchers::StartsWith("mine-20"));
    const auto json = nlohmann::json::parse(file_text(folder / "results.json"));
    REQUIRE(json["rows"].size() == 6);
    CHECK(json["rows"][5]["tau"] == 0.25);
    CHECK(json["rows"][5]["g_r"] == 1.5);
    CHECK_THAT(json["command_line"].get<std::string>(), Contains("--tau 1,0.5,0.25"));
}

TEST_CASE("a field with irregular sources on top is followed by grids") {
    const Sandbox box("mixture");
    const Outcome outcome = box.run(
        "compare --field ugawg-polar-2 --centre 0.5 0.5 0.5 --radius 0.3 --h 0.05 "
        "--sampling random,poisson --structures uniform-trilinear --voxel 0.1 --output out" +
        quick);
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, Contains("field ugawg-polar-2, random sources") &&
                                Contains("field ugawg-polar-2, poisson sources"));
    const auto json = nlohmann::json::parse(file_text(box / "out" / "results.json"));
    REQUIRE(json["rows"].size() == 2);
    CHECK(json["rows"][1]["sampling"] == "poisson");
    CHECK(json["rows"][1]["field"] == "ugawg-polar-2");
    CHECK(json["settings"]["centre"] == nlohmann::json{0.5, 0.5, 0.5});
}

TEST_CASE("a domain may be given, and negative numbers in it") {
    const Sandbox box("domain");
    box.write("s.csv", sources_csv);
    const Outcome outcome = box.run(
        "compare --sources s.csv --structures K_oL --domain -1 2 -1.5 2 -0.5 2 --output out" +
        quick);
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    const auto json = nlohmann::json::parse(file_text(box / "out" / "results.json"));
    CHECK(json["settings"]["domain"] == nlohmann::json{-1, 2, -1.5, 2, -0.5, 2});
}

TEST_CASE("help, version and list") {
    const Sandbox box("help");
    const Outcome help = box.run("compare --help");
    CHECK(help.status == 0);
    CHECK_THAT(help.out, Contains("--tau") && Contains("(default: 1.25)"));
    CHECK_THAT(box.run("--version").out, Catch::Matchers::StartsWith("controlspace 0."));
    CHECK(box.run("--help").status == 0);
    CHECK(box.run("help").out == box.run("--help").out);
    CHECK(box.run("help compare").out == help.out);
    CHECK(box.run("help help").out == box.run("--help").out);
    const Outcome list = box.run("list");
    CHECK(list.status == 0);
    CHECK_THAT(list.out, Contains("K_Li") && Contains("s_M") && Contains("published-sphere"));
}

TEST_CASE("bad input ends with one line and status 2, and writes nothing") {
    const Sandbox box("refused");
    box.write("s.csv", sources_csv);
    box.write("nan.csv", "x,y,z,h\n0,0,0,0.1\n0,nan,0,0.1\n");
    box.write("bad.toml", "tau = 1\ntaus = 2\n");
    box.write("file", "");
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"", "subcommand"},
        {"compare --tua 1", "--tua"},
        {"compare --tau", "--tau"},
        {"build s.csv", "(see controlspace build --help)"},
        {"--tua", "(see controlspace --help)"},
        {"compare --tau x", "--tau: 'x' is not a number"},
        {"compare --tau 0", "--tau: 0 is not positive"},
        {"compare --g-r 1.2 --mmg-hgrad 1.3", "excludes"},
        {"compare --law cone --as-published", "excludes"},
        {"compare --intersection order-free --as-published", "excludes"},
        {"compare --law cones", "--law: unknown value 'cones'"},
        {"compare --structures K_X", "unknown structure 'K_X'"},
        {"compare --kd-depth 1000", "depth"},
        {"compare no.toml", "no.toml"},
        {"compare bad.toml", "bad.toml:2: unknown key 'taus', did you mean tau?"},
        {"compare a.toml b.toml", "b.toml"},
        {"comapre s.csv", "unknown command 'comapre', did you mean compare?"},
        {"help comapre", "unknown command 'comapre', did you mean compare?"},
        {"measure s.csv", "unknown command 'measure': give one of compare, info, "},
        {"compare --strutures K_oV s.csv",
         "unknown option --strutures, did you mean --structures?"},
        {"build s.csv --ouput=a.ctrl", "unknown option --ouput, did you mean --output?"},
        {"build s.csv -o a.ctrl --colour",
         "unknown option --colour (see controlspace build --help)"},
        {"--verison", "unknown option --verison, did you mean --version?"},
        {"compare --sources no.csv", "no.csv"},
        {"compare --sources nan.csv", "nan.csv:3"},
        {"compare --sources .", "."},
        {"compare --sources s.csv --domain 0 0.5 0 1 0 1", "domain"},
        {"compare --sources s.csv --domain 0 1 0 1", "--domain"},
        {"compare --sources s.csv --domain 0 1e300 0 1 0 1", "--domain"},
        {"compare --sources s.csv --rho 0.5", "rho"},
        {"compare --sources s.csv --radius 2", "radius"},
        {"compare --sources none", "neither sources nor a field"},
        {"compare --field cube", "--field: unknown value 'cube'"},
        {"compare --field ugawg-linear", "outside the domain [0, 1] x [0, 1] x [0, 1]"},
        {"compare --sources none --field ugawg-linear --domain 0 1 0 1 0 2", "ugawg-linear"},
        {"compare --field sphere --field-radius nan", "--field-radius"},
        {"compare --field sphere --field-lengths 0.1 -1", "--field-lengths: -1 is not positive"},
        {"compare --field-radius 0.5 --sources sphere", "field_radius"},
        {"compare --sources s.csv --sampling random", "sampling"},
        {"compare --sampling odd", "--sampling: unknown value 'odd'"},
        {"compare --name 'two\nlines'", "--name"},
        {"compare --sources s.csv --as-published", "published-sphere"},
        {"compare --sources s.csv --output file", "file"},
        {"compare --sources s.csv --output file/out", "file/out"},
        {"compare --sources s.csv --output /proc/none", "/proc/none"},
    }));
    INFO(arguments);
    check_refused(box.run(arguments), expected);
    CHECK_FALSE(fs::exists(box / "results"));
    CHECK_FALSE(fs::exists(box / "out"));
}

TEST_CASE("a case that fails is a row with its reason, and status 3") {
    const Sandbox box("failed");
    const Outcome outcome = box.run(
        "compare --sources sphere --h 0.05 --structures K_oL,K_oV --tau 1,100 --max-memory 0.001 "
        "--output out" +
        quick);
    INFO(outcome.err);
    CHECK(outcome.status == 3);
    const auto json = nlohmann::json::parse(file_text(box / "out" / "results.json"));
    CHECK(json["complete"] == true);
    REQUIRE(json["rows"].size() == 4);
    for (const auto& row : json["rows"]) CHECK((row["error"] != "") == (row["tau"] == 1));
    CHECK_THAT(outcome.err, Contains("raise tau"));
    CHECK_THAT(outcome.out, Contains("failed: ") && Contains("raise tau"));
}

TEST_CASE("a standard error that takes nothing does not stop the program") {
    const Sandbox box("stderr");
    box.write("s.csv", sources_csv);
    const auto run_with = [&](const std::string& redirection, const std::string& arguments) {
        return box.run(arguments, "exec sh -c 'exec \"$@\" " + redirection + "' sh ").status;
    };
    CHECK(run_with("2>/dev/full", "compare --sources none.csv") == 2);
    CHECK(run_with("2>/dev/full", "compare --sources s.csv --output full" + quick) == 0);
    CHECK(run_with("2>&-", "compare --sources s.csv --output closed" + quick) == 0);
    for (const char* folder : {"full", "closed"}) {
        CHECK(nlohmann::json::parse(file_text(box / folder / "results.json"))["complete"] == true);
    }
}

TEST_CASE("results that lie there are not written over") {
    const Sandbox box("twice");
    box.write("s.csv", sources_csv);
    const std::string arguments = "compare --sources s.csv --structures K_oL --output out" + quick;
    REQUIRE(box.run(arguments).status == 0);
    const std::string before = file_text(box / "out" / "results.json");
    check_refused(box.run(arguments), "contains results already");
    CHECK(file_text(box / "out" / "results.json") == before);
}

// Of a study of hours, by Ctrl-C in the midst of it, into `out`, after a shell command.
Outcome interrupted_after(const Sandbox& box, const std::string& command) {
    box.write("study.toml", "rho = 0.2\ntau = 0.05\nstructures = 'trees'\n[[runs]]\n");
    return box.run("compare study.toml --output out",
                   "(for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do sleep 0.5; "
                   "[ -e out/results.json ] && break; done; " +
                       command +
                       "; kill -INT $(cat pid)) & exec sh -c 'echo $$ >pid; exec \"$@\"' sh ");
}

TEST_CASE("Ctrl-C leaves whole files and status 130") {
    const Sandbox box("interrupt");
    const Outcome outcome = interrupted_after(box, "true");
    INFO(outcome.err);
    CHECK(outcome.status == 130);
    CHECK_THAT(
        outcome.err,
        Contains("interrupted: 0 of 12 cases done, in out; to continue, run the same command with "
                 "--resume out"));
    const auto json = nlohmann::json::parse(file_text(box / "out" / "results.json"));
    CHECK(json["complete"] == false);
    CHECK(std::distance(fs::directory_iterator(box / "out"), fs::directory_iterator()) == 2);
}

TEST_CASE("Ctrl-C, where the folder of results is gone, ends in an error and status 130") {
    const Sandbox box("interrupt-gone");
    const Outcome outcome = interrupted_after(box, "rm -r out");
    INFO(outcome.err);
    CHECK(outcome.status == 130);
    CHECK_THAT(outcome.err, Contains("controlspace: error: ") && Contains("out/results.json"));
}

TEST_CASE("an interrupted study goes on where it was") {
    const Sandbox box("resume");
    const std::string study =
        "compare --h 0.3 --structures K_L,K_oL,K_oV --splits s_L --law cone --access-points 100 "
        "--access-repeats 1 --fine-probe-grid 9 --kd-depth 100 ";
    REQUIRE(box.run(study + "--output out").status == 0);
    const auto results = [&] { return nlohmann::json::parse(file_text(box / "out/results.json")); };
    const auto whole = results();
    REQUIRE(whole["rows"].size() == 3);
    auto part = whole;
    part["complete"] = false;
    part["rows"].erase(1);
    part["rows"].erase(1);
    box.write("out/results.json", part.dump());

    check_refused(box.run(study + "--seed 2 --resume out"), "--resume out: seed differs");
    check_refused(box.run(study + "--resume none"), "none/results.json");
    check_refused(box.run(study + "--resume out --output two"), "--resume");
    const Outcome outcome = box.run(study + "--resume out");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(lines(outcome.err) == 2);  // the cases that were left
    const auto joined = results();
    CHECK(joined["complete"] == true);
    REQUIRE(joined["rows"].size() == 3);
    CHECK(joined["rows"][0] == whole["rows"][0]);
    for (const char* field : {"structure", "delta_R_max", "tree_nodes"}) {
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(joined["rows"][i][field] == whole["rows"][i][field]);
    }
    check_refused(box.run(study + "--resume out"), "complete");
    check_refused(box.run(study + "--tau 2 --resume out"), "no case 1 of this study");
}

TEST_CASE("a dry run lists the cases and writes nothing") {
    const Sandbox box("dry");
    const Outcome outcome = box.run("compare --h 0.1 --splits s_L --dry-run --output out");
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.out, Contains("K_oLA") && Contains("cases: about "));
    CHECK_FALSE(fs::exists(box / "out"));
    check_refused(box.run("compare --h -1 --dry-run"), "h");
}

}  // namespace controlspace::compare_test
