// SPDX-License-Identifier: Apache-2.0
#include "io/text/medit.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <sstream>

#include "controlspace/io/read_sources.h"
#include "sources/files.h"

namespace controlspace::medit_test {

using Catch::Matchers::Contains;

namespace {

const std::string mesh_head = "MeshVersionFormatted 2\nDimension 3\n";

std::string error_in_mesh(const std::string& text) {
    return error_of([&] { parse_medit_vertices(text, "m.mesh"); });
}

std::string error_in_solution(const std::string& text) {
    return error_of([&] { parse_medit_metrics(text, "m.sol"); });
}

}  // namespace

TEST_CASE("vertices of a mesh, however its words are laid out") {
    const std::vector<Point> expected{{0, 0.5, 1}, {-1, 2e-3, 4}};
    const auto read = [](const std::string& text) { return parse_medit_vertices(text, "m.mesh"); };
    CHECK(read(mesh_head + "Vertices\n2\n0 0.5 1 0\n-1 2e-3 4 7\nEnd\n") == expected);
    CHECK(read("MeshVersionFormatted\n1\nDimension\n3\nVertices 2\n0 0.5 1 0 -1 2e-3 4 7") ==
          expected);
    CHECK(read("# made by hand\r\n\r\nMeshVersionFormatted 2 # version\r\nDimension 3\r\n"
               "RequiredVertices 1\r\n2\r\nTriangles 1\r\n1 2 2 0\r\n"
               "Vertices # here\r\n2\r\n0 0.5 1 0\r\n-1\t2e-3 4 7\r\nEnd\r\n") == expected);
}

TEST_CASE("a scalar of a solution is the size, a tensor the Riemannian metric") {
    const auto sizes =
        parse_medit_metrics(mesh_head + "SolAtVertices\n2\n1 1\n0.5\n0.25\nEnd\n", "m.sol");
    REQUIRE(sizes.size() == 2);
    CHECK(sizes[0] == Metric::isotropic(0.5));
    CHECK(sizes[1] == Metric::isotropic(0.25));

    // M = (2 1 0.5; 1 3 0.25; 0.5 0.25 4) has the Riemannian metric M^-2, whose six numbers all
    // differ; written in Medit's order xx xy yy xz yz zz.
    const Metric m{2, 3, 4, 1, 0.5, 0.25};
    const Eigen::Matrix3d inverse = m.matrix().fullPivLu().inverse();
    const Eigen::Matrix3d r = inverse * inverse;
    std::ostringstream text;
    text.precision(17);
    text << mesh_head << "SolAtVertices 1 1 3 " << r(0, 0) << ' ' << r(0, 1) << ' ' << r(1, 1)
         << ' ' << r(0, 2) << ' ' << r(1, 2) << ' ' << r(2, 2) << " End";
    const auto tensors = parse_medit_metrics(text.str(), "m.sol");
    REQUIRE(tensors.size() == 1);
    CHECK(tensors[0].matrix().isApprox(m.matrix(), 1e-13));
}

TEST_CASE("planes, version 0 and capital letters, as BAMG writes them") {
    const std::string head = GENERATE("MeshVersionFormatted 0\n\nDimension\n2\n\n",
                                      "MESHVERSIONFORMATTED 1\nDIMENSION 2\nIdentifier\n\"a b\"\n");
    CHECK(parse_medit_vertices(head + "Vertices\n2\n0 0.5 1\n-1 2e-3 7\nEnd\n", "m.mesh") ==
          std::vector<Point>{{0, 0.5, 0}, {-1, 2e-3, 0}});
    CHECK(parse_medit_vertices(head + "VERTICES 1 3 4 0 TRIANGLES 1 1 1 1 0 END", "m.mesh") ==
          std::vector<Point>{{3, 4, 0}});
    CHECK(parse_medit_metrics(head + "SolAtVertices 1 1 1 0.5 End", "m.sol") ==
          std::vector{Metric::isotropic(0.5)});
    // Lengths 0.5 along (0.6, 0.8) and 0.25 across it, in the plane.
    const double a = 1 / 0.25, b = 1 / 0.0625;
    const double xx = 0.36 * a + 0.64 * b, xy = 0.48 * (a - b), yy = 0.64 * a + 0.36 * b;
    const auto tensors = parse_medit_metrics(
        head + fmt::format("SOLATVERTICES 2 1 3 {} {} {} 4 0 4 END", xx, xy, yy), "m.sol");
    REQUIRE(tensors.size() == 2);
    CHECK(metric_length(tensors[0], {0.6, 0.8, 0}) == Approx(1 / 0.5));
    CHECK(metric_length(tensors[0], {-0.8, 0.6, 0}) == Approx(1 / 0.25));
    CHECK(metric_length(tensors[0], {0, 0, 1}) == Approx(1 / 0.5));
    CHECK(tensors[1] == Metric::isotropic(0.5));
    CHECK_THAT(error_in_solution(head + "SolAtVertices 1 1 3 1 2 1 End"),
               Contains("is not positive definite"));
}

TEST_CASE("rows that are longer than the dimension says are refused in text, too") {
    const std::string head = "MeshVersionFormatted 2\nDimension 2\n";
    CHECK_THAT(error_in_mesh(head + "Vertices 2\n0 0 0 1\n1 1 1 2\nEnd\n"),
               Contains("m.mesh:5: more numbers than the rows of Dimension 2 have"));
    CHECK_THAT(error_in_solution(head + "SolAtVertices 2 1 3\n1 0 1 0 0 1\n4 0 4 0 0 4\nEnd"),
               Contains("more numbers"));
    CHECK_THAT(error_in_solution(head + "SolAtVertices 2 1 1 0.5 0.25 -.5"),
               Contains("more numbers"));
    CHECK(parse_medit_vertices(head + "Vertices 1\n3 4 0  # 5\n", "m.mesh") ==
          std::vector<Point>{{3, 4, 0}});
}

TEST_CASE("tensors in another order are found out") {
    // The same tensor in the order of MMG's programming interface, xx xy xz yy yz zz.
    const std::string text =
        mesh_head + "SolAtVertices\n3\n1 3\n1 0 1 0 0 1\n1e4 90 -800 1 10 100\n1 0 1 0 0 1\n";
    CHECK_THAT(error_in_solution(text),
               Contains("m.sol:7: tensor 2 (10000 90 -800 1 10 100) is not positive "
                        "definite, 1 of 3 are not: is the order"));
    CHECK_THAT(error_in_solution(mesh_head + "SolAtVertices 2 1 3 0 0 0 0 0 0  -1 0 -1 0 0 -1"),
               Contains("m.sol:3: tensor 1 (0 0 0 0 0 0) is not positive definite, 2 of 2"));
}

TEST_CASE("a mesh without a solution has the lengths of its required edges") {
    const ScratchDirectory scratch("required");
    const auto mesh = [&](const std::string& rest) {
        return scratch.file(
            "a.mesh",
            "MeshVersionFormatted 2 Dimension 3 Vertices 4 0 0 0 0  3 0 0 0  3 4 0 0  9 9 9 0 "
            "Edges 3 1 2 0  2 3 0  3 4 0 " +
                rest + " End");
    };
    const auto sources = read_sources(mesh("RequiredEdges 2 1 2"));
    REQUIRE(sources.size() == 3);
    CHECK(sources[0] == PointSource{{0, 0, 0}, Metric::isotropic(3)});
    CHECK(sources[1] == PointSource{{3, 0, 0}, Metric::isotropic(3.5)});
    CHECK(sources[2] == PointSource{{3, 4, 0}, Metric::isotropic(4)});
    CHECK_THAT(error_of([&] { read_sources(mesh("")); }),
               Contains("no RequiredEdges") && Contains(".sol"));
    CHECK_THAT(error_of([&] { read_sources(mesh("RequiredEdges 1 4")); }),
               Contains("required edge 1"));
    const auto flat =
        scratch.file("b.mesh",
                     "MeshVersionFormatted 2 Dimension 3 Vertices 2 0 0 0 0  0 0 0 0 Edges 1 1 2 0 "
                     "RequiredEdges 1 1 End");
    CHECK_THAT(error_of([&] { read_sources(flat); }), Contains("edge 1 has the length 0"));
}

TEST_CASE("errors of a mesh name the place") {
    CHECK_THAT(error_in_mesh(""), Contains("m.mesh is empty"));
    CHECK_THAT(error_in_mesh("solid stl\n"), Contains("m.mesh:1"));
    CHECK_THAT(error_in_mesh("MeshVersionFormatted 9\n"), Contains("1 to 4"));
    CHECK_THAT(error_in_mesh("MeshVersionFormatted two\n"), Contains("'two' instead of a count"));
    CHECK_THAT(error_in_mesh("MeshVersionFormatted 2\nDimension 4\nVertices\n1\n0 0 0\n"),
               Contains("m.mesh:2: Dimension is 4"));
    CHECK_THAT(error_in_mesh("MeshVersionFormatted 2\nVertices\n1\n0 0 0 0\n"),
               Contains("no Dimension before Vertices"));
    CHECK_THAT(error_in_mesh(mesh_head + "End\n"), Contains("m.mesh has no Vertices"));
    CHECK_THAT(error_in_mesh(mesh_head), Contains("has no Vertices"));
    const std::string vertices = mesh_head + "Vertices\n";
    CHECK_THAT(error_in_mesh(vertices), Contains("the data end within Vertices"));
    CHECK_THAT(error_in_mesh(vertices + "-5\n0 0 0 0\n"),
               Contains("m.mesh:4: Vertices -5: nothing to read"));
    CHECK_THAT(error_in_mesh(vertices + "0\n"), Contains("nothing to read"));
    CHECK_THAT(error_in_mesh(vertices + "1000000000000\n0 0 0 0\n"),
               Contains("can hold 1 there at most"));
    CHECK_THAT(error_in_mesh(vertices + "99999999999999999999999\n0 0 0 0\n"),
               Contains("instead of a count"));
    CHECK_THAT(error_in_mesh(vertices + "2\n0 0 0 0\n0.125 0.375 1\n"),
               Contains("the data end within vertex 2"));
    CHECK_THAT(error_in_mesh(vertices + "2\n0 0 0 0\n0 x 0 0\n"),
               Contains("m.mesh:6: vertex 2: 'x' is not a number"));
    CHECK_THAT(error_in_mesh(vertices + "1\n0 nan 0 0\n"), Contains("vertex 1 has nan"));
    CHECK_THAT(error_in_mesh(vertices + "1\n0 1e99 0 0\n"),
               Contains("vertex 1 has a coordinate 1e+99: give finite ones, of at most 1e+50"));
}

TEST_CASE("errors of a solution name the place") {
    const std::string head = mesh_head + "SolAtVertices\n";
    CHECK_THAT(error_in_solution(mesh_head + "SolAtTetrahedra\n1\n1 1\n1\n"),
               Contains("m.sol has no SolAtVertices"));
    CHECK_THAT(error_in_solution(head + "2\n2 1 3\n1 1 1 1 1 1 1\n"), Contains("2 fields"));
    CHECK_THAT(error_in_solution(head + "2\n1 2\n1 1 1 1 1 1\n"), Contains("field of type 2"));
    CHECK_THAT(error_in_solution(head + "2\n1 1\n0.5 0\n"), Contains("size 2 is 0"));
    CHECK_THAT(error_in_solution(head + "2\n1 1\n-0.5 1\n"), Contains("size 1 is -0.5"));
    CHECK_THAT(error_in_solution(head + "2\n1 1\n0.5\n"),
               Contains("m.sol:7: the data end within size 2"));
    CHECK_THAT(error_in_solution(head + "2\n1 3\n1 0 1 0 0 1 1 0 1\n"),
               Contains("the data end within tensor 2"));
    CHECK_THAT(error_in_solution(head + "2\n1 3\n1 0 1 0 0 inf\n"),
               Contains("m.sol:6: tensor 1 has inf"));
    CHECK_THAT(error_in_solution(head + "4000000000\n1 3\n1 0 1 0 0 1\n"), Contains("at most"));
}

TEST_CASE("a mesh and a solution of other sizes do not belong together") {
    const ScratchDirectory scratch;
    const auto mesh = scratch.file("a.mesh", mesh_head + "Vertices\n2\n0 0 0 0\n1 1 1 0\nEnd\n");
    const auto solution = scratch.file("a.sol", mesh_head + "SolAtVertices\n1\n1 1\n0.5\nEnd\n");
    CHECK_THAT(error_of([&] { read_medit_sources(mesh, solution); }),
               Contains("has 2 vertices") && Contains("has sizes for 1"));
}

}  // namespace controlspace::medit_test
