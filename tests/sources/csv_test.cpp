// SPDX-License-Identifier: Apache-2.0
#include "io/text/csv.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "sources/files.h"

namespace controlspace::csv_test {

using Catch::Matchers::Contains;

namespace {

std::vector<PointSource> parse(std::string_view text) { return parse_csv_sources(text, "s.csv"); }

std::string error_in(std::string_view text) {
    return error_of([&] { parse(text); });
}

}  // namespace

TEST_CASE("CSV with sizes") {
    const auto sources = parse("x,y,z,h\n1,2,3,0.5\n-1e-3,+2.5,0,1E2\n");
    REQUIRE(sources.size() == 2);
    CHECK(sources[0] == PointSource{{1, 2, 3}, Metric::isotropic(0.5)});
    CHECK(sources[1] == PointSource{{-1e-3, 2.5, 0}, Metric::isotropic(100)});
}

TEST_CASE("CSV with gradation ratios of sources") {
    const auto sources = parse("x,y,z,h,g\n1,2,3,0.5,1.1\n1,2,3,0.5,0\n");
    REQUIRE(sources.size() == 2);
    CHECK(sources[0] == PointSource{{1, 2, 3}, Metric::isotropic(0.5), 1.1});
    CHECK(sources[1] == PointSource{{1, 2, 3}, Metric::isotropic(0.5)});
    const Metric m{0.3, 0.25, 0.2, 0.05, -0.02, 0.01};
    const auto tensors =
        parse("g,x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n2,1,2,3,.3,.25,.2,.05,-.02,.01\n");
    CHECK(tensors[0] == PointSource{{1, 2, 3}, m, 2});
    CHECK_THAT(error_in("x,y,z,h,g\n1,2,3,0.5,1\n1,2,3,0.5,0.9\n"), Contains("s.csv:3: g = 0.9"));
    CHECK_THAT(error_in("x,y,z,h,g\n1,2,3,0.5,nan\n"), Contains("s.csv:2: g = "));
    const ScratchDirectory scratch("growths");
    for (const auto& some : {sources, tensors}) {
        write_csv_sources(scratch / "again.csv", some);
        CHECK(read_csv_sources(scratch / "again.csv") == some);
    }
}

TEST_CASE("CSV with tensors, columns in any order") {
    const Metric m{0.3, 0.25, 0.2, 0.05, -0.02, 0.01};
    const auto sources =
        parse("m_yz,z,m_xx,M_YY,x,m_zz,m_xz,y,m_xy\n0.01,3,0.3,0.25,1,0.2,-0.02,2,0.05\n");
    REQUIRE(sources.size() == 1);
    CHECK(sources[0] == PointSource{{1, 2, 3}, m});
}

TEST_CASE("CSV with lengths and directions") {
    const std::string head = "x,y,z,h1,h2,h3,e1x,e1y,e1z,e2x,e2y,e2z\n";
    const auto sources = parse(head +
                               "0,0,0,0.1,0.2,0.4,1,0,0,0,1,0\n"
                               "0,0,0,1,3,5,5,-5,0,0.1,0.1,0\n"
                               "0,0,0,0.1,0.2,0.4,0,0,1e-30,1e40,0,0\n");
    REQUIRE(sources.size() == 3);
    CHECK(sources[0].metric == Metric{0.1, 0.2, 0.4, 0, 0, 0});
    const Metric turned = sources[1].metric;  // 1 along (1,-1,0), 3 along (1,1,0)
    CHECK(turned.matrix().isApprox(Metric{2, 2, 5, 1, 0, 0}.matrix(), 1e-15));
    CHECK(sources[2].metric == Metric{0.2, 0.4, 0.1, 0, 0, 0});
    CHECK_THAT(error_in(head + "0,0,0,1,2,3,1,0,0,1,1,0\n"), Contains("s.csv:2: e1 and e2"));
    CHECK_THAT(error_in(head + "0,0,0,1,2,3,0,0,0,1,1,0\n"), Contains("is zero"));
    CHECK_THAT(error_in(head + "0,0,0,1,-2,3,1,0,0,0,1,0\n"), Contains("h2 = -2"));
    // Nearly orthogonal directions are made so.
    const auto rounded = parse(head + "0,0,0,1,2,3,1,0,0,0.0005,1,0\n");
    CHECK(rounded[0].metric.matrix().isApprox(Metric{1, 2, 3, 0, 0, 0}.matrix(), 1e-3));
    CHECK(eigen_frame(rounded[0].metric).lengths[2] == Approx(3).epsilon(1e-14));
}

TEST_CASE("CSV in the ways that programs write it") {
    const auto plain = parse("x,y,z,h\n1,2,3,0.5\n4,5,6,0.25\n");
    CHECK(parse("x,y,z,h\r\n1,2,3,0.5\r\n4,5,6,0.25\r\n") == plain);
    CHECK(parse("x,y,z,h\n1,2,3,0.5\n4,5,6,0.25") == plain);
    CHECK(parse("# sizes\n\n X , Y,\tZ,H \n\n1, 2 ,3,0.5\n# more\n   \n4,5,6,0.25\n\n") == plain);
    const ScratchDirectory scratch;
    CHECK(read_csv_sources(scratch.file("bom.csv", "\xEF\xBB\xBFx,y,z,h\n1,2,3,0.5\n4,5,6,0.25")) ==
          plain);
}

TEST_CASE("tables as ParaView, pandas, Excel and Fortran write them") {
    const auto plain = parse("x,y,z,h\n1,2,3,0.5\n4,5,6,0.25\n");
    const std::string text = GENERATE(
        "\"h\",\"Points:0\",\"Points:1\",\"Points:2\"\n0.5,1,2,3\n0.25,4,5,6\n",
        "\"Points_0\",\"Points_1\",\"Points_2\",\"h\"\n1,2,3,0.5\n4,5,6,0.25\n",
        "x;y;z;h\n1;2,0;3;0,5\n4;5;6;0,25\n", "x;y;z;h\r\n1;2;3;0.5\r\n4;5;6;.25\r\n",
        "x\ty\tz\th\n1\t2\t3\t0,5\n4\t5\t6\t0.25\n", ",x,y,z,h\n0,1,2,3,0.5\n1,4,5,6,0.25\n",
        "index,x,y,z,name,h\n0,1,2,3,\"a, b\",0.5\n1,4,5,6,c,0.25\n",
        "x,y,z,h\n1D0,2d+0,3.,5D-1\n4,5,6,0.025D1\n",
        "x,y,z,h\n1,2,3,0.5\n,,,\n4,5,6,0.25\n , ,,\n", "x,y,z,h,\n1,2,3,0.5,\n4,5,6,0.25,\n",
        "\"x\";\"y\";\"z\";\"h\"\n\"1\";\"2\";\"3\";\"0,5\"\n4;5;6;0,25");
    CAPTURE(text);
    CHECK(parse(text) == plain);
    CHECK(parse_csv_points(text, "s.csv").size() == 2);
}

TEST_CASE("columns that are not read are named once") {
    std::vector<std::string> said;
    const auto read = [&](const std::string& text) {
        said.clear();
        parse_csv_sources(text, "s.csv",
                          {.remark = [&](const std::string& r) { said.push_back(r); }});
    };
    read("id,x,y,z,h,g,\"a, b\"\n1,1,2,3,0.5,0,7\n2,1,2,3,0.5,0,7\n");
    REQUIRE(said.size() == 1);
    CHECK(said[0] == "s.csv: columns that are not read: 'id', 'a, b'");
    read("x,y,z,h\n1,2,3,0.5\n");
    CHECK(said.empty());
    std::string wide = "x,y,z,h", row = "1,2,3,0.5";
    for (int i = 0; i < 50; ++i) {
        wide += ",c" + std::to_string(i);
        row += ",0";
    }
    read(wide + "\n" + row + "\n");
    CHECK_THAT(said.at(0), Catch::Matchers::EndsWith("'c19' and 30 more"));
    CHECK_THAT(error_in("Points:0,Points:1,x,y,z,h\n1,2,1,2,3,1\n"), Contains("there twice"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,0,5\n"), Contains("5 columns instead of 4"));
    CHECK_THAT(error_in("x;y;z;h\n1;2;3;0,5,1\n"), Contains("h = '0,5,1' is not a number"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,1d\n"), Contains("h = '1d' is not a number"));
}

TEST_CASE("CSV errors name the line and the fault") {
    CHECK_THAT(error_in(""), Contains("s.csv holds no sources"));
    CHECK_THAT(error_in("\n# nothing\n"), Contains("holds no sources"));
    CHECK_THAT(error_in("x,y,z,h\n"), Contains("holds no sources"));
    CHECK_THAT(error_in("1,2,3,0.5\n"),
               Contains("s.csv:1: column 'x' is missing: name the columns in the first line ('1', "
                        "'2', '3', '0.5')"));
    CHECK_THAT(error_in("x,y,z,size\n"), Contains("no metric") && Contains("'size'"));
    CHECK_THAT(error_in("x,y,h\n"), Contains("column 'z' is missing"));
    CHECK_THAT(error_in("x,y,z\n"), Contains("no metric"));
    CHECK_THAT(error_in("x,y,z,h,h\n"), Contains("'h' is there twice"));
    CHECK_THAT(error_in("x,y,z,h,m_xx\n"), Contains("'m_yy' is missing"));
    CHECK_THAT(error_in("x,y,z,h,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n"), Contains("two ways"));
    CHECK_THAT(error_in("x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz\n"), Contains("'m_yz' is missing"));
    CHECK_THAT(error_in("x,y,z,h1,h2,h3\n"), Contains("'e1x' is missing"));
    CHECK_THAT(error_in("x,y,z,h\n\n1,2,3\n"), Contains("s.csv:3: 3 columns instead of 4"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,4,5\n"), Contains("5 columns instead of 4"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,\n"), Contains("h = '' is not a number"));
    CHECK_THAT(error_in("x,y,z,h\n1,two,3,1\n"), Contains("y = 'two' is not a number"));
    CHECK_THAT(error_in("x,y,z,h\n1,2 3,3,1\n"), Contains("'2 3'"));
    CHECK_THAT(error_in("x,y,z,h\n1,+-2,3,1\n"), Contains("'+-2'"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,1e999\n"), Contains("'1e999'"));
    CHECK_THAT(error_in("x,y,z,h\nnan,2,3,1\n"), Contains("x = nan"));
    CHECK_THAT(error_in("x,y,z,h\n1,inf,3,1\n"), Contains("y = inf"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,1e300,1\n"), Contains("z = 1e+300"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,0\n"), Contains("h = 0"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,-1\n"), Contains("h = -1"));
    CHECK_THAT(error_in("x,y,z,h\n1,2,3,1e-300\n"), Contains("h = 1e-300"));
    const std::string tensor = "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n";
    CHECK_THAT(error_in(tensor + "0,0,0,1,1,1,2,0,0\n"),
               Contains("s.csv:2: tensor 1 (1 1 1 2 0 0) is not positive definite, 1 of 1"));
    CHECK_THAT(error_in(tensor + "0,0,0,0,0,0,0,0,0\n"), Contains("not positive definite"));
    CHECK_THAT(error_in(std::string("x,y,z,h\n1,2,\0,4\n", 16)), Contains("z = '?'"));
}

TEST_CASE("what was written as CSV reads back to the last bit") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    const ScratchDirectory scratch;
    std::vector<PointSource> isotropic;
    std::vector<PointSource> tensors;
    for (int i = 0; i < 500; ++i) {
        const Point p(unit(random), 1e20 * unit(random), 1e-20 * unit(random));
        const double h = std::pow(10, 6 * unit(random));
        isotropic.push_back({p, Metric::isotropic(h)});
        tensors.push_back({p, h * Metric{1 + 0.1 * unit(random), 2, 3, 0.1 * unit(random),
                                         0.1 * unit(random), 0.1 * unit(random)}});
    }
    const auto path = scratch.path() / "sources.csv";
    for (const auto& sources : {isotropic, tensors}) {
        write_csv_sources(path, sources);
        CHECK(read_csv_sources(path) == sources);
    }
    // Nothing but the file itself is left.
    const std::filesystem::directory_iterator files(scratch.path());
    CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("writing CSV fails in the open and leaves nothing behind") {
    const ScratchDirectory scratch;
    const std::vector<PointSource> sources(10000, PointSource{{1, 2, 3}, Metric::isotropic(0.1)});
    CHECK_THAT(error_of([&] { write_csv_sources(scratch.path(), sources); }),
               Contains("is a directory"));
    CHECK_THAT(error_of([&] { write_csv_sources(scratch.path() / "no" / "s.csv", sources); }),
               Contains("cannot write"));
    CHECK(std::filesystem::is_empty(scratch.path()));
    if (std::filesystem::exists("/dev/full")) {
        CHECK_THAT(error_of([&] { write_csv_sources("/dev/full", sources); }),
                   Contains("No space left"));
        CHECK_THAT(error_of([&] {
                       write_csv_sources("/dev/full", {sources.data(), 1});
                   }),
                   Contains("No space left"));
    }
}

TEST_CASE("writing replaces the file behind a symbolic link") {
    const ScratchDirectory scratch;
    const auto target = scratch.file("target.csv", "old");
    const auto link = scratch.path() / "link.csv";
    std::filesystem::create_symlink(target, link);
    const std::vector<PointSource> sources{{{1, 2, 3}, Metric::isotropic(0.1)}};
    write_csv_sources(link, sources);
    CHECK(std::filesystem::is_symlink(link));
    CHECK(read_csv_sources(target) == sources);
}

}  // namespace controlspace::csv_test
