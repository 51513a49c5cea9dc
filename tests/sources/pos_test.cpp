// SPDX-License-Identifier: Apache-2.0
#include "io/text/pos.h"

#include <catch2/catch.hpp>

#include "sources/files.h"

namespace controlspace::pos_test {

using Catch::Matchers::Contains;

namespace {

std::vector<PointSource> parsed(const std::string& text, const std::string& view = "") {
    return parse_pos_sources(text, "v.pos", {.array = view});
}
std::string error_in(const std::string& text, const std::string& view = "") {
    return error_of([&] { parsed(text, view); });
}

}  // namespace

TEST_CASE("scalars are sizes, tensors Riemannian metrics by rows") {
    const auto sizes = parsed(
        "// sizes\nView \"h\" {\n  SP(1,-2.5, 3e-1) { 0.25 };\n/* a\n line */ SP "
        "(0,0,0){0.5};};\n");
    CHECK(sizes == std::vector<PointSource>{{{1, -2.5, 0.3}, Metric::isotropic(0.25)},
                                            {{0, 0, 0}, Metric::isotropic(0.5)}});
    // 𝓜 with 1/4, 1/16 and 1/25 along x, y and z turned by 30 degrees around z: h = 2, 4, 5.
    const auto tensors = parsed(
        "View \"m\"{TP(0,0,0){0.203125,0.08118988160479113,0,0.08118988160479113,0.109375,0,"
        "0,0,0.04};};");
    REQUIRE(tensors.size() == 1);
    const Metric& m = tensors[0].metric;
    const double c = std::sqrt(3) / 2, s = 0.5;
    CHECK(metric_length(m, {c, s, 0}) == Approx(1 / 2.0));
    CHECK(metric_length(m, {-s, c, 0}) == Approx(1 / 4.0));
    CHECK(metric_length(m, {0, 0, 1}) == Approx(1 / 5.0));
}

TEST_CASE("elements give a source at each corner, and shared corners one") {
    const auto sources = parsed(
        "View \"h\" {SS(0,0,0, 1,0,0, 0,1,0, 0,0,1){1,2,3,4};"
        "SS(1,1,1, 1,0,0, 0,1,0, 0,0,1){5,2,3,9};};");
    REQUIRE(sources.size() == 6);
    CHECK(sources[1] == PointSource{{1, 0, 0}, Metric::isotropic(2)});
    CHECK(sources[4] == PointSource{{1, 1, 1}, Metric::isotropic(5)});
    // The same place with another value is another source.
    CHECK(sources[5] == PointSource{{0, 0, 1}, Metric::isotropic(9)});
    const std::string unit = "1,0,0,0,1,0,0,0,1";
    CHECK(parsed("View \"m\" {TS(0,0,0,1,0,0,0,1,0,0,0,1){" + unit + "," + unit + "," + unit + "," +
                 unit + "};};")
              .size() == 4);
}

TEST_CASE("tensors at one place that differ in one number are two sources") {
    const std::string first = "4,0.5,0.25,0.5,4,0.125,0.25,0.125,4";
    for (const char* other :
         {"8,0.5,0.25,0.5,4,0.125,0.25,0.125,4", "4,0.5,0.25,0.5,8,0.125,0.25,0.125,4",
          "4,0.5,0.25,0.5,4,0.125,0.25,0.125,8", "4,1,0.25,1,4,0.125,0.25,0.125,4",
          "4,0.5,1,0.5,4,0.125,1,0.125,4", "4,0.5,0.25,0.5,4,1,0.25,1,4"}) {
        CAPTURE(other);
        CHECK(parsed("View \"m\" {TL(0,0,0,1,0,0){" + first + "," + first + "};TL(0,0,0,1,0,0){" +
                     other + "," + first + "};};")
                  .size() == 3);
    }
}

TEST_CASE("of several steps in time of a view the last is read, or the one that is named") {
    std::string said;
    const auto read = [&](const std::string& text, std::optional<std::uint64_t> step = {}) {
        said.clear();
        return parse_pos_sources(
            text, "v.pos",
            {.step = step, .remark = [&](const std::string& remark) { said += remark; }});
    };
    const std::string lines =
        "View \"h\" {\nSL(0,0,0, 1,0,0){1,2, 3,4, 5,6};\nSP(2,0,0){7,8,9};\nTIME{0,0.5,1};\n};";
    const auto source = [](double x, double h) {
        return PointSource{{x, 0, 0}, Metric::isotropic(h)};
    };
    CHECK(read(lines) == std::vector{source(0, 5), source(1, 6), source(2, 9)});
    CHECK_THAT(said, Contains("v.pos: view 'h' has 3 steps in time: the last is taken, number 2"));
    CHECK(read(lines, 0) == std::vector{source(0, 1), source(1, 2), source(2, 7)});
    CHECK(read(lines, 1) == std::vector{source(0, 3), source(1, 4), source(2, 8)});
    CHECK(said.empty());
    CHECK_THAT(error_of([&] { read(lines, 3); }),
               Contains("v.pos: view 'h' has no step 3 in time: name one of 0, 1, 2"));
    CHECK_THAT(error_in("View \"h\" {\nSP(0,0,0){1,1};\nSP(1,0,0){1};};"),
               Contains("v.pos:3: 1 numbers instead of 2: of first order, and of 2 steps in time"));
    CHECK_THAT(error_in("View \"h\" {\nSL(0,0,0,1,0,0){1,1,1};};"),
               Contains("v.pos:2: 3 numbers instead of 2: of first order, and of 1 step"));
    const std::string unit = "1,0,0,0,1,0,0,0,1", quarter = "4,0,0,0,4,0,0,0,4";
    CHECK(parsed("View \"m\" {TP(0,0,0){" + unit + "," + quarter + "};};").front() ==
          source(0, 0.5));
    CHECK(read("View \"h\" {SP(0,0,0){1};};\n").size() == 1);
    CHECK(said.empty());
}

TEST_CASE("of several views one is named") {
    const std::string two = "View \"a\" {SP(0,0,0){1};};\nView \"b\" {SP(0,0,0){2};};\n";
    CHECK(parsed(two, "b").front().metric == Metric::isotropic(2));
    CHECK_THAT(error_in(two), Contains("v.pos: 2 of its views can be meant: name one of 'a', 'b'"));
    CHECK_THAT(error_in(two, "c"), Contains("0 of its views can be meant: name one of 'a', 'b'"));
}

TEST_CASE("sources that are written as a view are read back") {
    const ScratchDirectory scratch;
    std::vector<PointSource> sources{{{0.1, -0.2, 0.3}, {0.3, 0.4, 0.5, 0.02, -0.03, 0.05}},
                                     {{1e-9, 4, 1e9}, {0.35, 0.45, 0.55, -0.01, 0.06, 0.07}}};
    write_pos_sources(scratch.path() / "a.pos", sources);
    const auto read = read_pos_sources(scratch.path() / "a.pos");
    REQUIRE(read.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(read[i].position == sources[i].position);
        CHECK(read[i].metric.matrix().isApprox(sources[i].metric.matrix(), 1e-13));
    }
    for (PointSource& s : sources) s.metric = Metric::isotropic(s.metric.xx);
    write_pos_sources(scratch.path() / "a.pos", sources);
    CHECK(read_pos_sources(scratch.path() / "a.pos") == sources);
}

TEST_CASE("what is wrong in a view is named with its line") {
    CHECK_THAT(error_in("// nothing\n"), Contains("v.pos:2: no View"));
    CHECK_THAT(error_in("solid a\n"), Contains("v.pos:1: 'View' expected, 'solid a?' found"));
    CHECK_THAT(error_in("View \"h\n{"), Contains("v.pos:1: a name without an end"));
    CHECK_THAT(error_in("View \"h\" {\n"), Contains("v.pos:2: '' is no element"));
    CHECK_THAT(error_in("View \"h\" {};"), Contains("holds no sources"));
    const auto element = [](const std::string& text) {
        return error_in("View \"h\" {\n" + text + "\n};");
    };
    CHECK_THAT(element("VP(0,0,0){1,1,1};"), Contains("v.pos:2: 'VP' is no element"));
    CHECK_THAT(element("SP(0,0){1};"), Contains("2 numbers instead of 3"));
    CHECK_THAT(element("SP(0,0,zero){1};"),
               Contains("v.pos:2: an element: 'zero' is not a number"));
    CHECK_THAT(element("SP(0,0,0){nan};"),
               Contains("v.pos:2: size 1 is nan: a length must be positive"));
    CHECK_THAT(element("SP(0,0,inf){1};"), Contains("v.pos:2: corner 1 has a coordinate inf"));
    CHECK_THAT(element("SP(0,0,0){-1};"), Contains("size 1 is -1"));
    CHECK_THAT(element("SP(0,0,0){1}"), Contains("v.pos:3: ';' expected, '};' found"));
    CHECK_THAT(element("TP(0,0,0){1,2,0,0,1,0,0,0,1};"), Contains("v.pos:2: tensor 1 is not symm"));
    CHECK_THAT(element("TP(0,0,0){1,2,0,2,1,0,0,0,1};"),
               Contains("v.pos:2: tensor 1 (1 2 0 2 1 0 0 0 1) is not positive definite, 1 of 1"));
}

}  // namespace controlspace::pos_test
