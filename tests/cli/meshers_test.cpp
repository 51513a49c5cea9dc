// SPDX-License-Identifier: Apache-2.0
// End to end: lengths for meshers, by files and by a pipe.
#include <array>
#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cli/sandbox.h"

namespace controlspace::meshers_test {

using Catch::Matchers::Contains;

namespace {

const std::string sources_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";

/// Numbers of a text, without lines that begin with #.
std::vector<double> numbers(const std::string& text) {
    std::istringstream in(text);
    std::vector<double> all;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("#")) continue;
        std::istringstream words(line);
        for (double x = 0; words >> x;) all.push_back(x);
    }
    return all;
}

/// Places inside the sources' box, the same each time, with their lengths by `query`.
struct Places {
    std::vector<std::array<double, 3>> x;
    std::vector<double> lengths;

    Places(const Sandbox& box, const std::string& field) {
        std::ostringstream csv;
        csv.precision(17);
        csv << "x,y,z\n";
        unsigned state = 1;
        const auto fraction = [&] {
            state = state * 1664525u + 1013904223u;
            return 0.01 + 0.98 * (state >> 8) / double{1 << 24};
        };
        for (int i = 0; i < 1000; ++i) {
            const double a = fraction(), b = fraction(), c = fraction();
            x.push_back({a, b, c});
            csv << a << ',' << b << ',' << c << '\n';
        }
        box.write("places.csv", csv.str());
        REQUIRE(box.run("query " + field + " places.csv -o answers.csv").status == 0);
        std::istringstream rows(file_text(box / "answers.csv"));
        std::string line;
        std::getline(rows, line);
        while (std::getline(rows, line)) {
            lengths.push_back(std::stod(line.substr(line.rfind(',') + 1)));
        }
        REQUIRE(lengths.size() == x.size());
    }
};

std::string bytes_of(const std::vector<std::array<double, 3>>& places) {
    std::string bytes(places.size() * sizeof(places[0]), '\0');
    std::memcpy(bytes.data(), places.data(), bytes.size());
    return bytes;
}

std::vector<double> doubles(const std::string& bytes) {
    REQUIRE(bytes.size() % sizeof(double) == 0);
    std::vector<double> x(bytes.size() / sizeof(double));
    std::memcpy(x.data(), bytes.data(), bytes.size());
    return x;
}

}  // namespace

TEST_CASE("a pipe answers places by lengths, until NaN or its end") {
    const Sandbox box("pipe");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    const Places places(box, "f.ctrl");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    auto asked = places.x;
    const bool with_nan = GENERATE(true, false);
    if (with_nan) {
        asked.push_back({nan, nan, nan});
        asked.push_back({0, 0, 0});  // not read any more
    }
    box.write("asked", bytes_of(asked));
    const Outcome outcome = box.run("query f.ctrl --pipe <asked");
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.empty());
    const std::vector<double> answers = doubles(outcome.out);
    REQUIRE(answers.size() == places.lengths.size());
    for (std::size_t i = 0; i < answers.size(); ++i) {
        REQUIRE(answers[i] == Approx(places.lengths[i]).epsilon(1e-12));
    }
}

TEST_CASE("a pipe answers each place before the next is sent") {
    const Sandbox box("pipe-one");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    box.write("a", bytes_of({{0, 0, 0}}));
    box.write("b", bytes_of({{0.5, 0.5, 0.5}, {1, 1, 1}}));
    // The second half of a place, and what is asked next, are sent only once answers are there.
    const Outcome outcome = box.run(
        "query f.ctrl --pipe <in >out & exec 3>in 4<out; head -c 7 a >&3; sleep 0.1; "
        "tail -c +8 a >&3; timeout 20 head -c 8 <&4 >first; cat b >&3; "
        "timeout 20 head -c 16 <&4 >second; exec 3>&-; wait $!",
        "mkfifo in out; ");
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    const auto first = doubles(file_text(box / "first")),
               second = doubles(file_text(box / "second"));
    REQUIRE(first.size() == 1);
    REQUIRE(second.size() == 2);
    CHECK(first[0] == Approx(0.1).epsilon(0.1));
    CHECK(second[1] == Approx(0.4).epsilon(0.1));
}

TEST_CASE("a pipe that cannot be answered ends with one line") {
    const Sandbox box("pipe-refused");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    box.write("broken", bytes_of({{0, 0, 0}}).substr(0, 13));
    check_refused(box.run("query f.ctrl --pipe <broken"), "the last place has 13 of 24 bytes");
    check_refused(box.run("query f.ctrl s.csv --pipe"), "leave out POINTS");
    check_refused(box.run("query f.ctrl --pipe -o a.csv"), "excludes");
    check_refused(box.run("query - --pipe <s.csv"), "standard input");
    check_refused(box.run("query f.ctrl"), "no POINTS");
    box.write("whole", bytes_of({{0, 0, 0}}));
    const Outcome full = box.run("query f.ctrl --pipe <whole >/dev/full 2>.full; exit $?;");
    CHECK(full.status == 2);
}

TEST_CASE("sizes for Gmsh, JIGSAW, Netgen and TetGen") {
    const Sandbox box("export-sizes");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"-o a.structured", "a.structured: 2146689 nodes of a field Structured of Gmsh"},
        {"-o a.structured --samples 20", "a.structured: 8000 nodes"},
        {"-o a.msh --samples 20", "a.msh: 8000 nodes of a grid for JIGSAW"},
        {"-o a.msz", "points with mesh sizes for Netgen"},
        {"-o a.b.mtr", "nodes of a background mesh for TetGen"},
        {"-o a.b.node", "a.b.node: "},
    }));
    const Outcome outcome = box.run("export f.ctrl " + arguments);
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.empty());
    CHECK_THAT(outcome.out, Contains(expected));
    if (expected.find("points") == expected.npos) {
        CHECK_THAT(outcome.out, Contains("99 % of 1000 random places within 1.0"));
    }
}

TEST_CASE("sizes that mislead are warned of") {
    const Sandbox box("export-sizes-warned");
    box.write("s.csv", sources_csv);
    box.write("thin.csv",
              "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n0,0,0,0.1,0.4,0.4,0,0,0\n1,1,1,1,1,1,0,0,0\n");
    const Outcome coarse = box.run("export sphere --h 0.05 -o a.msh --samples 5");
    CHECK_THAT(coarse.err, Contains("warning: a.msh: ") && Contains("more --samples"));
    const Outcome jumps = box.run("export s.csv -o a.b.ele --structures K_oL");
    CHECK_THAT(jumps.err, Contains("smaller jumps (K_oV, --within 1.1)"));
    // The points of a .poly, or of the .node that it leaves them to.
    box.write("a.poly", "# a part\n0 3 0 0 # in a.node\n1 0\n");
    box.write("a.node", "4 3 1 0\n1 0 0 0 7\n\n# the top\n2 1 0 0 7\n3 0 1 0 7\n4 0 0 5 7\n");
    const Outcome beyond = box.run("export s.csv -o a.b.ele");
    CHECK(beyond.status == 0);
    CHECK_THAT(beyond.err, Contains("1 of 4 points of TetGen's input are outside the domain ["));
    box.write("a.poly", "2 3 0 0\n1 0 0 0\n2 1 x 0\n");
    CHECK_THAT(box.run("export s.csv -o a.b.ele").err,
               Contains("a.poly:3: point 2: 'x' is not a number: not compared"));
    const Outcome thin = box.run("export thin.csv -o a.msz");
    INFO(thin.err);
    CHECK(thin.status == 0);
    CHECK_THAT(thin.err, Contains("the smallest of each tensor"));
}

TEST_CASE("files of sizes that cannot be written end with one line, and leave none") {
    const Sandbox box("export-sizes-refused");
    box.write("s.csv", sources_csv);
    box.write("part.node", "0 3 0 0\n");
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    const auto [arguments, expected] = GENERATE(table<std::string, std::string>({
        {"-o part.node", "name part.b.node"},
        {"-o a.msh --samples 1", "1 samples along the longest edge: give 2 to 512"},
        {"-o a.msz --samples 9", "--samples is for .structured, .msh, .vti, .npy and .nc"},
        {"-o no/a.structured", "cannot write"},
        {"-o no/a.b.mtr", "cannot write"},
    }));
    check_refused(box.run("export f.ctrl " + arguments), expected);
    CHECK(file_text(box / "part.node") == "0 3 0 0\n");
    CHECK_FALSE(fs::exists(box / "a.msh"));
    CHECK_FALSE(fs::exists(box / "a.msz"));
    // Before anything is read or built.
    check_refused(box.run("export none.csv -o part.node"), "name part.b.node");
    check_refused(box.run("export none.csv -o a.structured --samples 1"), "give 2 to 512");
}

// TetGen interpolates in the background mesh at the vertices of its input, and writes what it
// found.
TEST_CASE("TetGen finds the lengths of the structure in its background mesh") {
    if (std::system("command -v tetgen >/dev/null 2>&1") != 0) {
        WARN("skipped: no tetgen (Debian's package of this name)");
        SUCCEED("no tetgen");
        return;
    }
    const Sandbox box("tetgen");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("build s.csv -o f.ctrl").status == 0);
    const Places places(box, "f.ctrl");
    std::ostringstream poly;
    poly.precision(17);
    poly << 8 + places.x.size() << " 3 0 0\n";
    for (int i = 0; i < 8; ++i)
        poly << i + 1 << ' ' << (i & 1) << ' ' << (i >> 1 & 1) << ' ' << (i >> 2) << '\n';
    for (std::size_t i = 0; i < places.x.size(); ++i) {
        const auto& [x, y, z] = places.x[i];
        poly << i + 9 << ' ' << x << ' ' << y << ' ' << z << '\n';
    }
    poly << "6 0\n1\n4 1 2 4 3\n1\n4 5 6 8 7\n1\n4 1 2 6 5\n1\n4 3 4 8 7\n1\n4 1 3 7 5\n1\n"
            "4 2 4 8 6\n0\n0\n";
    box.write("part.poly", poly.str());
    const Outcome outcome =
        box.run("export f.ctrl -o part.b.mtr >.report && tetgen -pmQ part.poly");
    INFO(outcome.out << outcome.err);
    REQUIRE(outcome.status == 0);
    const auto node = numbers(file_text(box / "part.1.node")),
               mtr = numbers(file_text(box / "part.1.mtr"));
    const std::size_t all = 8 + places.x.size();
    REQUIRE(node.size() >= 4 + 4 * all);
    REQUIRE(mtr.size() >= 2 + all);
    std::vector<double> factors;
    for (std::size_t i = 0; i < places.x.size(); ++i) {
        REQUIRE(node[4 + 4 * (8 + i) + 1] == Approx(places.x[i][0]));
        const double ratio = mtr[2 + 8 + i] / places.lengths[i];
        factors.push_back(std::max(ratio, 1 / ratio));
    }
    std::ranges::sort(factors);
    // Linear pieces of a trilinear field: 2 % at the middles of their edges, where it was looked.
    CAPTURE(factors[989], factors[999]);
    CHECK(factors[989] < 1.03);
    CHECK(factors[999] < 1.06);
}

}  // namespace controlspace::meshers_test
