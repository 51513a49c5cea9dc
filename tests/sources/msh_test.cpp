// SPDX-License-Identifier: Apache-2.0
// Meshes of Gmsh as they are written by hand; tests/mesh reads those that Gmsh wrote.
#include "io/text/msh.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "sources/files.h"

namespace controlspace::msh_test {

using Catch::Matchers::Contains;

namespace {

const std::string mesh =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 3 1 3\n0 1 0 3\n1\n2\n3\n"
    "0 0 0\n1 0 0\n2 0 0\n$EndNodes\n$Elements\n1 2 1 2\n1 1 1 2\n1 1 2\n2 2 3\n$EndElements\n";
const std::string old_mesh =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 2 0 0\n$EndNodes\n"
    "$Elements\n3\n1 1 2 7 7 1 2\n2 1 0 2 3\n3 15 3 1 2 3 1\n$EndElements\n";

/// Lengths at nodes 1 and 2.
std::string data_at(int step, double h) {
    return fmt::format("$NodeData\n1\n\"size\"\n1\n0.5\n3\n{}\n1\n2\n1 {}\n2 {}\n$EndNodeData\n",
                       step, h, h);
}

std::vector<PointSource> parsed(const std::string& text, const ReadOptions& options = {}) {
    return parse_msh_sources(text, "a.msh", options);
}

PointSource source(double x, double h) { return {{x, 0, 0}, Metric::isotropic(h)}; }

}  // namespace

TEST_CASE("of several steps in time the last is read, or the one that is named") {
    std::vector<std::string> remarks;
    const auto remark = [&](const std::string& text) { remarks.push_back(text); };
    const std::string ordered = mesh + data_at(0, 1) + data_at(1, 0.5) + data_at(7, 0.1);
    const std::string shuffled = mesh + data_at(7, 0.1) + data_at(0, 1) + data_at(1, 0.5);
    for (const std::string& text : {ordered, shuffled}) {
        remarks.clear();
        CHECK(parsed(text, {.remark = remark}) == std::vector{source(0, 0.1), source(1, 0.1)});
        REQUIRE(remarks.size() == 1);
        CHECK_THAT(remarks[0],
                   Contains("a.msh: view 'size' has 3 steps in time: the last is taken, "
                            "number 7 (--source-step chooses)"));
        CHECK(parsed(text, {.step = 0}).front() == source(0, 1));
        CHECK(parsed(text, {.step = 1, .remark = remark}).front() == source(0, 0.5));
        CHECK(remarks.size() == 1);
        CHECK_THAT(error_of([&] { parsed(text, {.step = 2}); }),
                   Contains("view 'size' has no step 2 in time: name one of 0, 1, 7"));
    }
    remarks.clear();
    parsed(mesh + data_at(4, 1), {.remark = remark});
    CHECK(remarks.empty());
}

TEST_CASE("values at the corners of elements are sources there, once where they are shared") {
    const auto data = [](const std::string& rows) {
        return "$ElementNodeData\n1\n\"size\"\n1\n0\n3\n0\n1\n2\n" + rows + "$EndElementNodeData\n";
    };
    const std::string both = GENERATE(mesh, old_mesh);
    CHECK(parsed(both + data("1 2 0.1 0.2\n2 2 0.2 0.3\n")) ==
          std::vector{source(0, 0.1), source(1, 0.2), source(2, 0.3)});
    CHECK(parsed(both + data("1 2 0.1 0.2\n2 2 0.4 0.3\n")).size() == 4);
    const auto error = [&](const std::string& rows) {
        return error_of([&] { parsed(both + data(rows)); });
    };
    CHECK_THAT(error("1 3 1 1 1\n2 2 1 1\n"),
               Contains("a.msh: 3 values for element 1, which has 2 nodes"));
    CHECK_THAT(error("9 2 1 1\n2 2 1 1\n"), Contains("data for element 9, which is not there"));
    CHECK_THAT(error("1 0\n2 2 1 1\n"), Contains("element 1 has 0 corners"));
    CHECK_THAT(error("1 2000000000 1\n2 2 1 1\n"), Contains("cut off"));
}

TEST_CASE("meshes of format 2 are read") {
    CHECK(parsed(old_mesh + data_at(0, 0.5)) == std::vector{source(0, 0.5), source(1, 0.5)});
    const std::string of_elements =
        "$ElementData\n1\n\"size\"\n1\n0\n3\n0\n1\n2\n2 0.25\n3 0.125\n$EndElementData\n";
    CHECK(parsed(old_mesh + of_elements) == std::vector{source(1.5, 0.25), source(0, 0.125)});
    const auto error = [](std::string text, const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
        return error_of([&] { parsed(text); });
    };
    const std::string text = old_mesh + of_elements;
    CHECK_THAT(error(text, "$Nodes\n3", "$Nodes\n2000000000"), Contains("cut off"));
    CHECK_THAT(error(text, "$Elements\n3", "$Elements\n-3"), Contains("'-3' instead of a count"));
    CHECK_THAT(error(text, "2.2 0 8", "3 0 8"), Contains("only 4.1 and 2.2 can be read"));
    CHECK_THAT(error(text, "3 15 3 1 2 3 1", "3 99 3 1 2 3 1"), Contains("unknown type 99"));
    CHECK_THAT(error(text, "3 15 3 1 2 3 1", "3 15 3 1 2 3 8"),
               Contains("a node that is not there"));
}

}  // namespace controlspace::msh_test
