// SPDX-License-Identifier: Apache-2.0
// Files of meshes, read back by other means than they were written with.
#include <catch2/catch.hpp>
#include <cstring>
#include <regex>

#include "controlspace/fields/formula_field.h"
#include "controlspace/mesh/conformity.h"
#include "controlspace/mesh/mesh_files.h"
#include "files/text_file.h"
#include "io/text/medit.h"
#include "mesh/fixtures.h"
#include "sources/files.h"

namespace controlspace::writers_test {

using Catch::Matchers::Contains;

namespace {

const FormulaField skew(skew_metric);

std::vector<Metric> metrics_of(const TetMesh& mesh) {
    std::vector<Metric> metrics(mesh.vertices.size());
    skew.sample(mesh.vertices, metrics);
    return metrics;
}

/// The array of that name in a .vtu file, whose raw data begin behind the underscore.
template <class Value>
std::vector<Value> vtu_array(const std::string& file, const std::string& name) {
    std::smatch match;
    const std::regex element("Name=\"" + name +
                             "\" NumberOfComponents=\"\\d+\" format=\"appended\" "
                             "offset=\"(\\d+)\"");
    const std::string head = file.substr(0, file.find("<AppendedData"));
    REQUIRE(std::regex_search(head, match, element));
    const std::size_t begin = file.find("\n_") + 2 + std::stoull(match[1]);
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, &file.at(begin), sizeof bytes);
    REQUIRE(begin + sizeof bytes + bytes <= file.size());
    std::vector<Value> values(bytes / sizeof(Value));
    std::memcpy(values.data(), &file[begin + sizeof bytes], bytes);
    return values;
}

}  // namespace

TEST_CASE("Medit files hold vertices and Riemannian metrics, as their reader takes them") {
    const ScratchDirectory folder;
    const TetMesh mesh = kuhn_mesh(2);
    const std::vector<Metric> metrics = metrics_of(mesh);
    write_medit_mesh(folder.path() / "box.mesh", mesh);
    write_medit_solution(folder.path() / "box.sol", metrics);
    const auto sources = read_medit_sources(folder.path() / "box.mesh", folder.path() / "box.sol");
    REQUIRE(sources.size() == mesh.vertices.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        REQUIRE(sources[i].position == mesh.vertices[i]);
        const Eigen::Matrix3d difference = sources[i].metric.matrix() - metrics[i].matrix();
        REQUIRE(difference.norm() < 1e-13);
    }
}

TEST_CASE("a Medit solution of isotropic metrics is one of sizes, unless tensors are kept") {
    const ScratchDirectory folder;
    const std::vector<Metric> sizes{Metric::isotropic(0.5), Metric::isotropic(0.25)};
    const auto path = folder.path() / "a.sol";
    write_medit_solution(path, sizes);
    CHECK_THAT(read_text_file(path), Contains("1 1") && Contains("\n0.5 \n0.25 \n"));
    CHECK(parse_medit_metrics(read_text_file(path), path) == sizes);
    write_medit_solution(path, sizes, /*keep_tensors=*/true);
    CHECK_THAT(read_text_file(path), Contains("1 3") && Contains("\n4 0 4 0 0 4 \n"));
}

TEST_CASE("a .vtu file holds the mesh, its metrics and its qualities") {
    const ScratchDirectory folder;
    const TetMesh mesh = kuhn_mesh(2);
    const std::vector<Metric> metrics = metrics_of(mesh);
    write_vtu(folder.path() / "box.vtu", mesh, skew);
    std::ifstream stream(folder.path() / "box.vtu", std::ios::binary);
    const std::string file(std::istreambuf_iterator<char>(stream), {});

    const auto points = vtu_array<double>(file, "Points");
    REQUIRE(points.size() == 3 * mesh.vertices.size());
    const auto components = vtu_array<double>(file, "length_tensor");
    REQUIRE(components.size() == 6 * mesh.vertices.size());
    const auto smallest = vtu_array<double>(file, "h_min");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        REQUIRE(Point(points[3 * i], points[3 * i + 1], points[3 * i + 2]) == mesh.vertices[i]);
        const double* m = &components[6 * i];
        REQUIRE(Metric{m[0], m[1], m[2], m[3], m[5], m[4]} == metrics[i]);
        REQUIRE(smallest.at(i) == Approx(eigen_frame(metrics[i]).lengths[0]));
    }
    const auto corners = vtu_array<std::int64_t>(file, "connectivity");
    REQUIRE(corners.size() == 4 * mesh.tets.size());
    for (std::size_t i = 0; i < corners.size(); ++i) REQUIRE(corners[i] == mesh.tets[i / 4][i % 4]);
    const auto ends = vtu_array<std::int64_t>(file, "offsets");
    REQUIRE(ends.size() == mesh.tets.size());
    CHECK(ends.front() == 4);
    CHECK(ends.back() == static_cast<std::int64_t>(corners.size()));
    CHECK(vtu_array<std::uint8_t>(file, "types") ==
          std::vector<std::uint8_t>(mesh.tets.size(), 10));
    CHECK(vtu_array<double>(file, "quality") == tet_qualities(mesh, metrics));
    CHECK(vtu_array<double>(file, "edge_length").size() == mesh.tets.size());
}

TEST_CASE("a file that cannot be written is named") {
    const TetMesh mesh = kuhn_mesh(1);
    CHECK(error_of([&] { write_medit_mesh("/dev/full", mesh); }).find("/dev/full") == 13);
    CHECK(error_of([&] { write_vtu("/none/box.vtu", mesh, skew); }).find("/none/box.vtu") == 13);
}

}  // namespace controlspace::writers_test
