// SPDX-License-Identifier: Apache-2.0
#include "controlspace/io/read_sources.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "data_folder.h"
#include "io/text/medit.h"
#include "io/text/npy.h"
#include "sources/files.h"

namespace controlspace::read_sources_test {

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

const std::filesystem::path samples = data_folder() / "samples";

}  // namespace

TEST_CASE("the sample files can be read") {
    CHECK(read_sources(samples / "helix.csv").size() == 64);
    CHECK(read_sources(samples / "tensors.csv").front().metric ==
          Metric{0.3, 0.25, 0.2, 0.05, -0.02, 0.01});
    const auto layer = read_sources(samples / "shear-layer.csv");
    REQUIRE(layer.size() == 81);
    for (const PointSource& s : layer) {
        // 0.01 along (1,0,1), 0.1 along y, 0.3 along (1,0,-1).
        CHECK(metric_length(s.metric, {1, 0, 1}) == Approx(std::sqrt(2) / 0.01));
        CHECK(metric_length(s.metric, {0, 1, 0}) == Approx(10));
        CHECK(metric_length(s.metric, {1, 0, -1}) == Approx(std::sqrt(2) / 0.3));
    }
}

TEST_CASE("the sample mesh asks for the polar benchmark metric") {
    // polar-1 of the UGAWG adaptation benchmarks: h_r = h0 + 2 (0.1 - h0) |r - 0.5|, h0 = 0.001,
    // and 0.1 around and along the z axis.
    const auto sources = read_sources(samples / "polar.mesh");
    CHECK(read_sources(samples / "polar.sol") == sources);
    REQUIRE(sources.size() == 125);
    for (const PointSource& s : sources) {
        const double r = std::hypot(s.position.x(), s.position.y());
        if (r == 0) continue;
        const Vector e_r(s.position.x() / r, s.position.y() / r, 0);
        const Vector e_t(-e_r.y(), e_r.x(), 0);
        const double h_r = 0.001 + 0.198 * std::abs(r - 0.5);
        CHECK(metric_length(s.metric, e_r) == Approx(1 / h_r).epsilon(1e-9));
        CHECK(metric_length(s.metric, e_t) == Approx(10).epsilon(1e-9));
        CHECK(metric_length(s.metric, Vector::UnitZ()) == Approx(10).epsilon(1e-9));
    }
    CHECK(finest_length(sources) == Approx(0.001).epsilon(1e-9));
}

TEST_CASE("the extension tells the format, in any case of letters") {
    const ScratchDirectory scratch;
    CHECK(read_sources(scratch.file("A.CSV", "x,y,z,h\n0,0,0,1\n")).size() == 1);
}

TEST_CASE("a mesh and its solution may be of either form") {
    const ScratchDirectory scratch;
    const auto sources = read_sources(samples / "polar.mesh");
    write_medit_sources(scratch.path() / "b.meshb", sources);
    fs::copy(samples / "polar.mesh", scratch.path() / "a.mesh");
    fs::rename(scratch.path() / "b.solb", scratch.path() / "a.solb");
    for (const char* name : {"a.mesh", "a.solb"}) {
        const auto mixed = read_sources(scratch.path() / name);
        REQUIRE(mixed.size() == sources.size());
        for (std::size_t i = 0; i < mixed.size(); ++i) {
            REQUIRE(mixed[i].metric.matrix().isApprox(sources[i].metric.matrix(), 1e-12));
        }
    }
}

TEST_CASE("rows of an array of NumPy are checked as those of a table") {
    const ScratchDirectory scratch("npy");
    const auto read = [&](double h, double growth) {
        const std::array row{0.1, 0.2, 0.3, h, growth};
        const std::string bytes(reinterpret_cast<const char*>(row.data()), sizeof row);
        return read_sources(scratch.file("a.npy", npy_header("1, 5") + bytes));
    };
    CHECK(read(0.5, 1.5).front() == PointSource{{0.1, 0.2, 0.3}, Metric::isotropic(0.5), 1.5});
    CHECK(read(0.5, 0).front().growth == 0);
    for (const double growth : {0.5, 0.999, -1.0, 1e9, std::nan("")}) {
        CHECK_THAT(error_of([&] { read(0.5, growth); }), Contains("row 0: g"));
    }
    for (const double h : {0.0, -1.0, std::nan("")}) {
        CHECK_THAT(error_of([&] { read(h, 1.5); }), Contains("row 0: h"));
    }
}

TEST_CASE("files that are not sources are named with the remedy") {
    const ScratchDirectory scratch;
    const auto error = [](const std::filesystem::path& path) {
        return error_of([&] { read_sources(path); });
    };
    CHECK_THAT(error(scratch.path() / "none.csv"), Contains("none.csv: no such file"));
    CHECK_THAT(error(scratch.path()), Contains("is a directory"));
    CHECK_THAT(error(scratch.file("empty.csv", "")), Contains("empty.csv is empty"));
    CHECK_THAT(error(scratch.file("bom.csv", "\xEF\xBB\xBF")), Contains("bom.csv is empty"));
    CHECK_THAT(error(scratch.file("a.txt", "x")), Contains("name a .csv"));
    CHECK_THAT(error(scratch.file("a", "x")), Contains("name a .csv"));
    CHECK_THAT(error(scratch.file("lonely.meshb", "x")), Contains("lonely.solb is missing"));
    CHECK_THAT(error(scratch.file("lonely.mesh", "MeshVersionFormatted 2\n")),
               Contains("lonely.sol is missing"));
    CHECK_THAT(error(scratch.file("alone.sol", "MeshVersionFormatted 2\n")),
               Contains("alone.mesh is missing"));
    scratch.file("both.mesh", "");
    CHECK_THAT(error(scratch.file("both.sol", "")), Contains("is empty"));
    const auto folder = scratch.path() / "folder.csv";
    std::filesystem::create_directory(folder);
    CHECK_THAT(error(folder), Contains("is a directory"));
}

}  // namespace controlspace::read_sources_test
