// SPDX-License-Identifier: Apache-2.0
// Sources of a study: primitives, files, limits of lengths.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "cli/paper_reference.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/run.h"
#include "controlspace/study/workload.h"
#include "fields/values.h"
#include "metric/draw.h"
#include "scratch_directory.h"

namespace controlspace::sources_test {

using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

const std::string ball = "ball:0.5,0.5,0.5,r=0.1,h=0.02",
                  segment = "segment:0,0,0,1,1,1,h=0.05,g=1.1";

const Parameter<Study>& row(const std::string& key) {
    return *std::ranges::find(study_parameters(), key, &Parameter<Study>::key);
}

/// As words of the command line, which are between commas.
Study with_sources(const std::string& text) {
    Values words;
    for (std::size_t first = 0; first <= text.size();) {
        const std::size_t end = std::min(text.find(',', first), text.size());
        words.emplace_back(text.substr(first, end - first));
        first = end + 1;
    }
    Study study;
    set_checked(row("sources").access, study, words);
    return study;
}

std::string complaint(const std::string& text) {
    try {
        with_sources(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

Workload workload_of(const Study& study, const FileReaders& readers = {}) {
    return make_workload(study, study.sources, readers);
}

/// Sources of each file, whatever it is called.
FileReaders readers_of(std::vector<PointSource> sources) {
    FileReaders readers;
    readers.sources[".vtu"] = [sources](const std::filesystem::path&, const SourcesChoice&) {
        return sources;
    };
    return readers;
}

}  // namespace

TEST_CASE("primitives are given alike in words and in a study file, among files") {
    const Study words = with_sources("a.csv," + ball + ",b.stl," + segment);
    const Study file =
        parse_study("sources = ['a.csv', '" + ball + "', 'b.stl', '" + segment + "']", "s.toml");
    CHECK(words.sources == file.sources);
    CHECK(words.sources.kind == SourcesKind::file);
    CHECK(words.sources.files == std::vector<std::filesystem::path>{"a.csv", "b.stl"});
    REQUIRE(words.sources.primitives.size() == 2);
    CHECK(words.sources.primitives[1] == parse_primitive(segment));
    CHECK(sources_name(words.sources) == "a.csv,b.stl," + ball + "," + segment);

    CHECK(with_sources(ball).sources.kind == SourcesKind::none);
    CHECK(sources_name(with_sources(ball).sources) == ball);
    CHECK(with_sources("planes," + ball).sources.kind == SourcesKind::planes);
    CHECK(sources_name(with_sources("planes," + ball).sources) == "planes," + ball);
    CHECK(with_sources(ball + ",a.csv").sources.files.at(0) == "a.csv");
    for (const Study& study : {words, with_sources("planes," + ball), with_sources(ball)}) {
        Study again;
        set_checked(row("sources").access, again, row("sources").access.get(study));
        CHECK(again.sources == study.sources);
    }
    const Study beside = parse_study("sources = 'surface:part.stl,h=0.1'", "folder/s.toml");
    CHECK(beside.sources.primitives[0].file == "folder/part.stl");
    CHECK(input_files_of(beside.sources) == std::vector<std::filesystem::path>{"folder/part.stl"});
}

TEST_CASE("primitives that are wrong are refused with their text") {
    CHECK_THAT(complaint("a.csv,ball:0,0,0,r=-1,h=1,b.csv"), Contains("r=-1,h=1: r is -1"));
    CHECK_THAT(complaint("ball:0,0,0,radius=1,h=1"), Contains("unknown setting 'radius'"));
    CHECK_THAT(complaint("box:0,1,1,0,0,1,h=1"), Contains("give y0 < y1"));
    CHECK_THAT(complaint("ball:0,nan,0,r=1,h=1"), Contains("nan is no coordinate"));
    CHECK_THAT(complaint("sphere,planes," + ball), Contains("sphere is no file"));
    CHECK_THAT(complaint(ball + ",sphere,a.csv"), Contains("sphere is no file"));
    CHECK_THAT(complaint("a.csv," + ball + ",sphere"), Contains("sphere is no file"));
    CHECK_THROWS_WITH(parse_study("# c\nsources = ['ball:0,0,0,r=1,h=0']", "s.toml"),
                      Contains("s.toml:2: sources: ball:0,0,0,r=1,h=0: h is 0"));
    Study study = with_sources("surface:part.stl,h=0.1");
    CHECK_THROWS_WITH(workload_of(study), Contains("part.stl: this program is built without"));
    study = with_sources("ball:0,0,0,r=0.1,h=0.02," + ball);
    study.domain = Box{{0.3, 0.3, 0.3}, {1, 1, 1}};
    CHECK_THROWS_WITH(workload_of(study),
                      Contains("ball:0,0,0,r=0.1,h=0.02 lies outside the domain [0.3, 1]"));
}

TEST_CASE("primitives define the domain where there is nothing else") {
    const Workload alone = workload_of(with_sources("ball:1,2,3,r=2,h=0.1"));
    CHECK(alone.domain.low.isApprox(Point(-1.2, -0.2, 0.8)));
    CHECK(alone.domain.high.isApprox(Point(3.2, 4.2, 5.2)));
    CHECK(alone.sources.empty());
    CHECK(alone.finest_length == 0.1);
    const std::vector<PointSource> two{{Point::Zero(), Metric::isotropic(0.5)},
                                       {Point::Ones(), Metric::isotropic(0.01)}};
    // A ball may extend beyond the domain, and hold all of it.
    const Workload mixed =
        workload_of(with_sources("a.vtu,ball:0,0,0,r=9,h=0.02"), readers_of(two));
    CHECK(mixed.domain.high.isApprox(Point::Constant(1.05)));
    CHECK(mixed.finest_length == 0.01);
    CHECK(value_at(*mixed.field.field, {1, 0.5, -0.05}) == Metric::isotropic(0.02));
    const Box cube{Point::Constant(-1), Point::Constant(1)};
    CHECK(workload_of(with_sources("planes,ball:0,0,0,r=9,h=0.02")).domain == cube);
}

TEST_CASE("points and primitives together are the smallest of their closed forms") {
    Study study = with_sources("a.vtu," + ball + "," + segment);
    study.runs[0] = {{"structures", {"K_oV", "K_L", "direct", "uniform-trilinear"}},
                     {"g_r", {1.5}}};
    study.domain = Box{Point::Zero(), Point::Ones()};
    const std::vector<PointSource> points{{{0.9, 0.1, 0.5}, Metric::isotropic(0.04)},
                                          {{0.2, 0.8, 0.1}, Metric::isotropic(0.08)}};
    const auto expected = [&](const Point& x) {
        double h = study.domain->half_diagonal();
        for (const PointSource& s : points) {
            h = std::min(h, s.metric.xx + 0.5 * (x - s.position).norm());
        }
        const Vector v = x - x.mean() * Vector::Ones();  // from the diagonal
        h = std::min(h, 0.05 + 0.1 * v.norm());
        return std::min(h, 0.02 + 0.5 * std::max(0.0, (x - Point::Constant(0.5)).norm() - 0.1));
    };
    const auto cases = expand(study, program_rows());
    REQUIRE(cases.size() == 4);
    Draw draw(3);
    std::vector<Point> places;
    for (int i = 0; i < 2000; ++i) {
        places.emplace_back(draw.uniform(0, 1), draw.uniform(0, 1), draw.uniform(0, 1));
    }
    for (const Case& c : cases) {
        CAPTURE(c.structure);
        CHECK(c.sources.primitives_ratio == 1.5);
        CHECK(c.target_delta.has_value() == (c.structure != "direct"));
        const Workload workload = make_workload(study, c.sources, readers_of(points));
        const auto exact = make_reference(study, c, workload);
        const auto space = make_and_fill(study, c, program_rows(), workload).space;
        double worst = 1;
        for (const Point& x : places) {
            CHECK(value_at(*exact, x).xx == Approx(expected(x)).epsilon(1e-12));
            const double factor = value_at(*space, x).xx / expected(x);
            worst = std::max({worst, factor, 1 / factor});
        }
        // Trees and grids are adapted to 1.1 by default.
        CHECK(worst <= (c.structure == "direct" ? 1 + 1e-12 : 1.1));
    }
}

TEST_CASE("what is small beside a steep growth is found by trees") {
    // It reaches so little of the domain that no sampled place would show it.
    Study study = with_sources("ball:0.7371,0.2113,0.5419,r=0.0001,h=0.0001,g=5");
    study.runs[0] = {{"structures", {"K_oV", "K_oL", "K_V", "K_oLA"}}, {"splits", {"s_L"}}};
    study.sources.h_max = 0.01;
    study.domain = Box{Point::Zero(), Point::Ones()};
    for (const Case& c : expand(study, program_rows())) {
        CAPTURE(c.structure);
        const Workload workload = workload_of(study);
        const auto space = make_and_fill(study, c, program_rows(), workload).space;
        CHECK(value_at(*space, {0.7371, 0.2113, 0.5419}).xx < 1.2e-4);
        CHECK(value_at(*space, {0.1, 0.1, 0.1}).xx == Approx(0.01).epsilon(1e-3));
    }
}

TEST_CASE("limits hold for all that is requested") {
    Study study = with_sources("a.vtu,ball:0,0,0,r=0.1,h=0.001");
    const Metric thin = metric_from_frame({0.001, 0.05, 3}, Draw(1).rotation());
    const std::vector<PointSource> points{{Point::Ones(), Metric::isotropic(0.002)},
                                          {{1, 0, 0}, Metric::isotropic(7)},
                                          {{0, 1, 0}, Metric::isotropic(0.02)},
                                          {{0, 0, 1}, thin}};
    study.sources.h_min = 0.01;
    study.sources.h_max = 0.2;
    const Workload workload = workload_of(study, readers_of(points));
    CHECK(workload.sources[0].metric == Metric::isotropic(0.01));
    CHECK(workload.sources[1].metric == Metric::isotropic(0.2));
    CHECK(workload.sources[2].metric == Metric::isotropic(0.02));
    const EigenFrame frame = eigen_frame(workload.sources[3].metric);
    CHECK(frame.lengths[0] == Approx(0.01));
    CHECK(frame.lengths[1] == Approx(0.05));
    CHECK(frame.lengths[2] == Approx(0.2));
    const EigenFrame given = eigen_frame(thin);
    for (int i = 0; i < 3; ++i) {
        CHECK(std::abs(frame.directions.col(i).dot(given.directions.col(i))) == Approx(1));
    }
    CHECK(value_at(*workload.field.field, Point::Zero()) == Metric::isotropic(0.01));
    CHECK(value_at(*workload.field.field, Point::Ones()) == Metric::isotropic(0.2));
    CHECK(workload.finest_length == Approx(0.01));
    // What lies within the limits stays as it is, to the bit.
    study.sources.h_min = 0.0001;
    study.sources.h_max = 10;
    CHECK(workload_of(study, readers_of(points)).sources.all() == points);

    study.sources = with_sources(ball).sources;
    study.sources.h_min = 0.3;
    study.sources.h_max = 0.2;
    CHECK_THROWS_WITH(expand(study, program_rows()),
                      Contains("h_min is 0.3 and h_max 0.2: give h_min <= h_max"));
    CHECK_THROWS_WITH(set_checked(row("h_max").access, study, {Value(-1.0)}), Contains("-1"));
    set_checked(row("h_max").access, study, {Value(0.0)});
    CHECK(row("h_max").access.get(study).empty());
}

TEST_CASE("a source outside the domain is named with its index, file and line") {
    const ScratchDirectory folder;
    const auto a = folder.file("a.csv", "x,y,z,h\n0,0,0,1\n1,1,1,1\n");
    const auto b = folder.file("b.csv", "# note\n\nx,y,z,h\r\n0,0,0,1\n\n# 2\n0,0,5,1\n0,0,6,1\n");
    Study study = with_sources(a.string() + "," + b.string());
    study.domain = Box{Point::Constant(-2), Point::Constant(2)};
    CHECK_THROWS_WITH(workload_of(study),
                      Contains("source 3 (" + b.string() + ", line 7) at (0, 0, 5) lies outside"));
    study = with_sources(a.string() + ",b.vtu");
    study.domain = Box{Point::Constant(-2), Point::Constant(2)};
    const std::vector<PointSource> points{{Point::Zero(), Metric::isotropic(1)},
                                          {{0, 7, 0}, Metric::isotropic(1)}};
    CHECK_THROWS_WITH(workload_of(study, readers_of(points)),
                      Contains("source 3 (b.vtu, number 2) at (0, 7, 0) lies outside"));
    study = with_sources("sphere");
    study.domain = Box{Point::Constant(2), Point::Constant(3)};
    CHECK_THROWS_WITH(workload_of(study), Contains("source 0 at ("));
}

}  // namespace controlspace::sources_test
