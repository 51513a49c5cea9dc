// SPDX-License-Identifier: Apache-2.0
// Binary Medit files against ASCII ones, and against bytes put together by hand.
#include <catch2/catch.hpp>
#include <limits>

#include "files/text_file.h"
#include "io/text/medit.h"
#include "io/text/medit_file.h"
#include "sources/files.h"
#include "sources/medit_bytes.h"

namespace controlspace::medit_blocks_test {

using Catch::Matchers::Contains;

namespace {

constexpr std::int32_t vertices_code = 4, triangles_code = 6, solution_code = 62;
constexpr std::int32_t scalar = 1, symmetric_tensor = 3;

/// Numbers that a float holds.
const std::string mesh_text =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n2\n0.5 -0.25 2 7\n1 2 3 8\nEnd\n";
const std::string tensors_text =
    "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 3\n"
    "4 0.5 3 -0.75 0.25 2\n8 1 16 -2 3 32\nEnd\n";

std::string mesh_bytes(int version, bool swapped) {
    MeditBytes file(version, swapped);
    const std::size_t row = 3 * file.real_size() + file.integer_size();
    // A block that means nothing here comes first.
    file.block(triangles_code, file.integer_size() + 4 * file.integer_size());
    file.integer(1).integer(1).integer(2).integer(2).integer(5);
    file.block(vertices_code, file.integer_size() + 2 * row).integer(2);
    file.real(0.5).real(-0.25).real(2).integer(7);
    file.real(1).real(2).real(3).integer(8);
    return file.end().bytes();
}

std::string solution_bytes(int version, bool swapped, std::int32_t type,
                           std::initializer_list<double> values, std::int64_t count = 2) {
    MeditBytes file(version, swapped);
    file.block(solution_code, file.integer_size() + 8 + values.size() * file.real_size());
    file.integer(count).word(1).word(type);
    for (const double x : values) file.real(x);
    return file.end().bytes();
}

std::string error_in_mesh(const std::string& bytes) {
    return error_of([&] { parse_medit_vertices(bytes, "m.meshb"); });
}
std::string error_in_solution(const std::string& bytes) {
    return error_of([&] { parse_medit_metrics(bytes, "m.solb"); });
}

}  // namespace

TEST_CASE("binary files of all versions and byte orders say what ASCII ones say") {
    const int version = GENERATE(1, 2, 3, 4);
    const bool swapped = GENERATE(false, true);
    CAPTURE(version, swapped);
    CHECK(parse_medit_vertices(mesh_bytes(version, swapped), "m.meshb") ==
          parse_medit_vertices(mesh_text, "m.mesh"));
    CHECK(parse_medit_metrics(solution_bytes(version, swapped, symmetric_tensor,
                                             {4, 0.5, 3, -0.75, 0.25, 2, 8, 1, 16, -2, 3, 32}),
                              "m.solb") == parse_medit_metrics(tensors_text, "m.sol"));
    CHECK(parse_medit_metrics(solution_bytes(version, swapped, scalar, {0.5, 0.25}), "m.solb") ==
          std::vector{Metric::isotropic(0.5), Metric::isotropic(0.25)});
}

TEST_CASE("sources that are written as Medit files are read back") {
    const std::string name = GENERATE("a.mesh", "a.sol", "a.meshb", "a.solb");
    const ScratchDirectory scratch;
    std::vector<PointSource> sources{{{0.1, -0.2, 0.3}, {0.3, 0.4, 0.5, 0.02, -0.03, 0.05}},
                                     {{1e-9, 4, 1e9}, {0.35, 0.45, 0.55, -0.01, 0.06, 0.07}}};
    write_medit_sources(scratch.path() / name, sources);
    const char* ends = is_binary_medit_name(name) ? "b" : "";
    const auto mesh = scratch.path() / (std::string("a.mesh") + ends);
    const auto solution = scratch.path() / (std::string("a.sol") + ends);
    CHECK((read_binary_file(mesh).find("MeshVersion") != 0) == is_binary_medit_name(name));
    const auto read = read_medit_sources(mesh, solution);
    REQUIRE(read.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(read[i].position == sources[i].position);
        CHECK(read[i].metric.matrix().isApprox(sources[i].metric.matrix(), 1e-13));
    }
    for (PointSource& s : sources) s.metric = Metric::isotropic(0.1 + s.metric.xx);
    write_medit_sources(scratch.path() / name, sources);
    CHECK(read_medit_sources(mesh, solution) == sources);
}

TEST_CASE("where one file of a pair cannot be written, neither appears") {
    const std::string name = GENERATE("a.mesh", "a.sol", "a.meshb", "a.solb");
    const ScratchDirectory scratch;
    std::filesystem::create_symlink("/dev/full", scratch.path() / name);
    const std::vector<PointSource> one{{{0, 0, 0}, Metric::isotropic(1)}};
    CHECK_THAT(error_of([&] { write_medit_sources(scratch.path() / name, one); }),
               Contains(name + ": No space left on device"));
    const std::filesystem::directory_iterator files(scratch.path());
    CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("what is wrong in a binary mesh is named with its place") {
    CHECK_THAT(error_in_mesh(mesh_bytes(2, false).substr(0, 6)),
               Contains("m.meshb, byte 4: the data end within the version"));
    CHECK_THAT(error_in_mesh(MeditBytes(5).bytes()), Contains("the version is 5: only 1 to 4"));
    CHECK_THAT(error_in_mesh(MeditBytes(-1).bytes()), Contains("the version is -1"));
    CHECK_THAT(error_in_mesh(MeditBytes(2).end().bytes()), Contains("m.meshb has no Vertices"));
    CHECK_THAT(error_in_mesh(MeditBytes(2).bytes()), Contains("has no Vertices"));
    CHECK_THAT(error_in_mesh(MeditBytes(2).block(vertices_code, 1000).integer(1).bytes()),
               Contains("byte 28: the next keyword is said to be at byte 1028 of 32: is it cut"));
    CHECK_THAT(error_in_mesh(MeditBytes(2).word(5).place(3).bytes()),
               Contains("the next keyword is said to be at byte 3"));
    CHECK_THAT(error_in_mesh(MeditBytes(3).word(5).place(-3).bytes()), Contains("at byte -3"));
    for (const std::int64_t count : {std::int64_t{2'000'000'000}, std::int64_t{2}}) {
        CAPTURE(count);
        CHECK_THAT(error_in_mesh(MeditBytes(4)
                                     .block(vertices_code, 40)
                                     .integer(count)
                                     .raw(0.0)
                                     .raw(0.0)
                                     .raw(0.0)
                                     .integer(0)
                                     .end()
                                     .bytes()),
                   Contains("the file can hold 1 there at most"));
    }
    CHECK_THAT(error_in_mesh(MeditBytes(2).block(vertices_code, 4).integer(-7).bytes()),
               Contains("Vertices -7: nothing to read"));
    CHECK_THAT(error_in_mesh(MeditBytes(2).block(vertices_code, 4).integer(0).bytes()),
               Contains("Vertices 0: nothing to read"));
    std::string other_dimension = mesh_bytes(2, false);
    other_dimension[16] = 4;
    CHECK_THAT(error_in_mesh(other_dimension), Contains("Dimension is 4"));
    const auto with_first = [](double x) {
        return MeditBytes(2)
            .block(vertices_code, 32)
            .integer(1)
            .real(x)
            .real(0)
            .real(0)
            .integer(0)
            .bytes();
    };
    CHECK_THAT(error_in_mesh(with_first(std::numeric_limits<double>::quiet_NaN())),
               Contains("vertex 1 has nan"));
    CHECK_THAT(error_in_mesh(with_first(1e99)), Contains("vertex 1 has a coordinate 1e+99"));
}

TEST_CASE("rows that are longer than the dimension says are refused") {
    const int version = GENERATE(1, 2, 3, 4);
    const bool swapped = GENERATE(false, true);
    CAPTURE(version, swapped);
    const std::string_view why = "more numbers than the rows of Dimension 2 have";
    const auto of_the_plane = [&](std::string bytes) {
        bytes[swapped ? (version < 3 ? 19u : 23u) : (version < 3 ? 16u : 20u)] = 2;
        return bytes;
    };
    CHECK_THAT(error_in_mesh(of_the_plane(mesh_bytes(version, swapped))),
               Contains(std::string(why)));
    CHECK_THAT(
        error_in_solution(of_the_plane(solution_bytes(
            version, swapped, symmetric_tensor, {4, 0.5, 3, -0.75, 0.25, 2, 8, 1, 16, -2, 3, 32}))),
        Contains(std::string(why)));
    // Sizes have one number in any dimension, and the last block need not name a next one.
    CHECK(parse_medit_metrics(of_the_plane(solution_bytes(version, swapped, scalar, {0.5, 0.25})),
                              "m.solb") ==
          std::vector{Metric::isotropic(0.5), Metric::isotropic(0.25)});
    const auto last = [&](bool has_end) {
        MeditBytes file(version, swapped);
        file.word(vertices_code).place(0).integer(1);
        file.real(1).real(2).real(3).integer(8);
        return has_end ? file.end().bytes() : file.bytes();
    };
    for (const bool has_end : {false, true}) {
        CHECK(parse_medit_vertices(last(has_end), "m.meshb") == std::vector<Point>{{1, 2, 3}});
        CHECK_THAT(error_in_mesh(of_the_plane(last(has_end))), Contains(std::string(why)));
    }
}

TEST_CASE("what is wrong in a binary solution is named with its place") {
    const double infinite = std::numeric_limits<double>::infinity();
    CHECK_THAT(error_in_solution(mesh_bytes(2, true)), Contains("m.solb has no SolAtVertices"));
    CHECK_THAT(error_in_solution(solution_bytes(2, false, 2, {1, 1, 1, 1, 1, 1})),
               Contains("field of type 2"));
    CHECK_THAT(error_in_solution(solution_bytes(2, false, scalar, {0.5, -1})),
               Contains("size 2 is -1: a length must be positive"));
    CHECK_THAT(error_in_solution(solution_bytes(2, false, scalar, {0.5, infinite})),
               Contains("size 2 has inf"));
    CHECK_THAT(error_in_solution(solution_bytes(2, false, symmetric_tensor, {1, 0, 1, 0, 0})),
               Contains("the data end within tensor"));
    CHECK_THAT(error_in_solution(solution_bytes(2, false, scalar, {1, 1}, 2'000'000'000)),
               Contains("at most"));
    // The order of MMG's programming interface.
    CHECK_THAT(error_in_solution(solution_bytes(3, true, symmetric_tensor,
                                                {1, 0, 1, 0, 0, 1, 1e4, 90, -800, 1, 10, 100})),
               Contains("m.solb, byte ") &&
                   Contains("tensor 2 (10000 90 -800 1 10 100) is not positive definite, 1 of 2 "
                            "are not: is the order of their components xx xy yy xz yz zz?"));
}

}  // namespace controlspace::medit_blocks_test
