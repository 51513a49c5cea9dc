// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gmsh/gmsh_mesher.h"

#include <gmsh.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "controlspace/fields/formula_field.h"
#include "controlspace/mesh/conformity.h"
#include "controlspace/mesh/mesh_files.h"
#include "geometry/point_order.h"
#include "gmsh/gmsh_session.h"
#include "mesh/fixtures.h"
#include "sources/files.h"

namespace controlspace::gmsh_mesher_test {

using Catch::Matchers::Contains;

namespace {

const Box two_cube{Point::Constant(-1), Point::Constant(1)};

const FormulaField sphere([](const Point& p) { return around_sphere(p, 0.2); });

/// A cylinder of strips around x = 100, of radius 10 and height 30.
Part strips(VertexIndex n) {
    Part part;
    for (const double z : {0.0, 30.0}) {
        part.vertices.emplace_back(100, 0, z);
        for (VertexIndex i = 0; i < n; ++i) {
            const double angle = 2 * M_PI * i / n;
            part.vertices.emplace_back(100 + 10 * std::cos(angle), 10 * std::sin(angle), z);
        }
    }
    const VertexIndex top = n + 1;
    for (VertexIndex i = 0; i < n; ++i) {
        const VertexIndex a = 1 + i, b = 1 + (i + 1) % n;
        part.triangles.insert(
            part.triangles.end(),
            {{0, b, a}, {top, top + a, top + b}, {a, b, top + b}, {a, top + b, top + a}});
    }
    return part;
}

/// A cube with edges along the axes.
Part cube(const Point& low, double edge) {
    Part part;
    for (int i = 0; i < 8; ++i) {
        part.vertices.push_back(low + edge * Vector(i & 1, i >> 1 & 1, i >> 2));
    }
    for (const auto& [a, b, c, d] : std::initializer_list<Tetrahedron>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
        part.triangles.insert(part.triangles.end(), {{a, b, c}, {a, c, d}});
    }
    return part;
}

void add(Part& part, const Part& other) {
    const auto n = static_cast<VertexIndex>(part.vertices.size());
    part.vertices.insert(part.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& [a, b, c] : other.triangles) {
        part.triangles.push_back({a + n, b + n, c + n});
    }
}

const Box around_strips{Point(85, -15, -5), Point(115, 15, 35)};

/// Without printing either.
template <class List>
bool same(const List& a, const List& b) {
    return a == b;
}

}  // namespace

TEST_CASE("Gmsh fills the box with tetrahedra of the size that is asked for") {
    const GmshAlgorithm algorithm = GENERATE(GmshAlgorithm::delaunay, GmshAlgorithm::hxt);
    CAPTURE(static_cast<int>(algorithm));
    const MeshRun run = mesh_with_gmsh(two_cube, sphere, {.algorithm = algorithm});
    CHECK(volume(run.mesh) == Approx(8));
    CHECK(area(run.mesh) == Approx(24));
    for (const Tetrahedron& tet : run.mesh.tets) REQUIRE(signed_volume(run.mesh, tet) > 0);
    for (const Point& p : run.mesh.vertices) REQUIRE(two_cube.contains(p));
    const Conformity c = conformity(run.mesh, sphere);
    CHECK(c.mean_length == Approx(1).epsilon(0.1));
    CHECK(c.l_r > 0.55);
    CHECK(run.cost.queries > c.nodes / 4);
    CHECK(run.cost.query_seconds < run.cost.seconds);
    CHECK_FALSE(run.anisotropic);
}

TEST_CASE("one thread makes the same mesh again") {
    const MeshRun run = mesh_with_gmsh(two_cube, sphere);
    const MeshRun again = mesh_with_gmsh(two_cube, sphere);
    CHECK(same(again.mesh.vertices, run.mesh.vertices));
    CHECK(same(again.mesh.tets, run.mesh.tets));
    CHECK(again.cost.queries == run.cost.queries);
}

TEST_CASE("place and size of the domain do not change the mesh") {
    const Box box{Point::Zero(), Point::Constant(2)};
    const MeshRun large = mesh_with_gmsh(box, sphere);
    SECTION("a tiny one, by a power of two") {
        const double size = 0x1p-40;
        const Box tiny{box.low, size * box.high};
        const FormulaField field(
            [size](const Point& p) { return size * around_sphere(p / size, 0.2); });
        const MeshRun small = mesh_with_gmsh(tiny, field);
        CHECK(small.cost.queries == large.cost.queries);
        CHECK(same(small.mesh.tets, large.mesh.tets));
        CHECK(volume(small.mesh) / (size * size * size) == Approx(8));
    }
    SECTION("a far one") {
        const Point low(1e6, -1e6, 5e5);
        const FormulaField field([&](const Point& p) { return around_sphere(p - low, 0.2); });
        const MeshRun far = mesh_with_gmsh({low, low + box.edges()}, field);
        CHECK(volume(far.mesh) == Approx(8));
        CHECK(static_cast<double>(far.mesh.tets.size()) ==
              Approx(static_cast<double>(large.mesh.tets.size())).epsilon(0.05));
    }
}

TEST_CASE("of an anisotropic field, Gmsh is given the smallest length, and it is said") {
    const FormulaField thin([](const Point&) { return Metric{0.2, 0.4, 0.8, 0, 0, 0}; });
    const FormulaField smallest([](const Point&) { return Metric::isotropic(0.2); });
    const MeshRun run = mesh_with_gmsh(unit_box, thin);
    CHECK(run.anisotropic);
    CHECK(same(run.mesh.tets, mesh_with_gmsh(unit_box, smallest).mesh.tets));
}

TEST_CASE("a field that fails does so outside of Gmsh") {
    std::atomic<int> asked = 0;
    const auto after_some = [&](auto&& fail) {
        return FormulaField([&asked, fail](const Point& p) {
            // The estimate asks first.
            return ++asked > 14000 ? fail() : around_sphere(p, 0.2);
        });
    };
    struct OwnError {};
    const auto throwing = after_some([]() -> Metric { throw OwnError{}; });
    CHECK_THROWS_AS(mesh_with_gmsh(two_cube, throwing), OwnError);
    asked = 0;
    const auto wrong = after_some([] { return Metric{1, 1, -1, 0, 0, 0}; });
    CHECK_THAT(error_of([&] { mesh_with_gmsh(two_cube, wrong); }),
               Contains("is no metric") && Contains("(1 1 -1 0 0 0)"));
    // And Gmsh can be used again.
    CHECK_FALSE(mesh_with_gmsh(two_cube, sphere).mesh.tets.empty());
}

TEST_CASE("options out of range and meshes beyond all measure are refused") {
    const auto error_with = [](const GmshOptions& options) {
        return error_of([&] { mesh_with_gmsh(two_cube, sphere, options); });
    };
    CHECK_THAT(error_with({.factor = 0.0}), Contains("factor"));
    CHECK_THAT(error_with({.factor = std::nan("")}), Contains("factor"));
    CHECK_THAT(error_with({.optimize = 1.0}), Contains("optimize"));
    CHECK_THAT(error_with({.max_tets = 100}), Contains("tetrahedra, more than 1e+02"));
    const FormulaField fine([](const Point&) { return Metric::isotropic(1e-9); });
    CHECK_THAT(error_of([&] { mesh_with_gmsh(two_cube, fine); }), Contains("tetrahedra"));
    CHECK_THAT(error_of([&] {
                   mesh_with_gmsh({Point::Zero(), Point(1, 1, 0)}, sphere);
               }),
               Contains("domain"));
}

TEST_CASE("Gmsh fills a part that is given by its surface") {
    constexpr VertexIndex n = 48;
    const auto part = std::make_shared<const Part>(strips(n));
    const FormulaField field([](const Point& p) { return Metric::isotropic(2 + 0.1 * p.z()); });
    const MeshRun run = mesh_with_gmsh(around_strips, field, {.part = part});
    // The mesh is coarse: its edges cut off a part.
    CHECK(volume(run.mesh) == Approx(15 * n * 100 * std::sin(2 * M_PI / n)).epsilon(0.015));
    for (const Point& p : run.mesh.vertices) {
        CHECK(std::hypot(p.x() - 100, p.y()) < 10 + 1e-6);
        CHECK((p.z() > -1e-6 && p.z() < 30 + 1e-6));
    }
    const Conformity c = conformity(run.mesh, field);
    CHECK(c.l_r > 0.7);
    CHECK(c.mean_length == Approx(1).epsilon(0.1));

    CHECK_THAT(error_of([&] { mesh_with_gmsh(two_cube, field, {.part = part}); }),
               Contains("is not inside of the field's domain"));
    auto open = strips(n);
    open.triangles.resize(open.triangles.size() - 4);
    const auto hole = std::make_shared<const Part>(std::move(open));
    CHECK_THAT(error_of([&] { mesh_with_gmsh(around_strips, field, {.part = hole}); }),
               Contains("Gmsh"));
}

TEST_CASE("Gmsh fills all bodies of a surface, but not what is hollow in them") {
    // Inside of the first cube a hole, in that another cube with a hole, and a second one beside.
    Part part = cube({0, 0, 0}, 9);
    add(part, cube({1, 1, 1}, 6));
    add(part, cube({2, 2, 2}, 4));
    add(part, cube({3, 3, 3}, 1));
    add(part, cube({12, 0, 0}, 3));
    std::ranges::reverse(part.triangles);  // the order of shells does not matter
    const Box domain{Point(-1, -1, -1), Point(16, 10, 10)};
    const FormulaField field([](const Point&) { return Metric::isotropic(1.5); });
    const MeshRun run =
        mesh_with_gmsh(domain, field, {.part = std::make_shared<const Part>(std::move(part))});
    CHECK(volume(run.mesh) == Approx(729 - 216 + 64 - 1 + 27));
}

TEST_CASE("Gmsh fills all solids of a CAD file, which share faces where they touch") {
    const ScratchDirectory folder;
    const auto path = folder.path() / "three.step";
    in_gmsh_session(1, [&] {
        gmsh::model::occ::addBox(0, 0, 0, 4, 4, 4);
        gmsh::model::occ::addBox(4, 1, 1, 3, 2, 2);
        gmsh::model::occ::addBox(9, 0, 0, 2, 2, 2);
        gmsh::model::occ::synchronize();
        gmsh::write(path.string());
    });
    Part part;
    part.cad = path;
    const FormulaField field([](const Point&) { return Metric::isotropic(1); });
    const MeshRun run = mesh_with_gmsh({Point(-1, -1, -1), Point(12, 5, 5)}, field,
                                       {.part = std::make_shared<const Part>(part)});
    CHECK(volume(run.mesh) == Approx(64 + 12 + 8));
    std::size_t on_common_face = 0;
    for (const Triangle& t : run.mesh.triangles) {
        on_common_face += std::ranges::all_of(t, [&](VertexIndex v) {
            const Point& p = run.mesh.vertices[v];
            return std::abs(p.x() - 4) < 1e-6 && std::abs(p.y() - 2) < 1 + 1e-6 &&
                   std::abs(p.z() - 2) < 1 + 1e-6;
        });
    }
    CHECK(on_common_face > 4);
    auto places = run.mesh.vertices;
    std::ranges::sort(places, precedes);
    CHECK(std::ranges::adjacent_find(places, [](const Point& p, const Point& q) {
              return (p - q).norm() < 1e-6;
          }) == places.end());
}

TEST_CASE("Gmsh fills a solid of a CAD file") {
    const ScratchDirectory folder;
    const std::string name = GENERATE("part.step", "part.brep");
    const auto path = folder.path() / name;
    in_gmsh_session(1, [&] {
        gmsh::model::occ::addCylinder(100, 0, 0, 0, 0, 30, 10);
        gmsh::model::occ::synchronize();
        gmsh::write(path.string());
    });
    Part part;
    part.cad = path;
    const FormulaField field([](const Point&) { return Metric::isotropic(3); });
    const auto solid = std::make_shared<const Part>(part);
    const MeshRun run = mesh_with_gmsh(around_strips, field, {.part = solid});
    CHECK(volume(run.mesh) == Approx(M_PI * 3000).epsilon(0.03));
    CHECK(conformity(run.mesh, field).l_r > 0.7);
    CHECK_THAT(error_of([&] { mesh_with_gmsh(two_cube, field, {.part = solid}); }),
               Contains("is not inside of the field's domain"));
    part.cad = folder.path() / "none.step";
    const auto none = std::make_shared<const Part>(part);
    CHECK_THAT(error_of([&] { mesh_with_gmsh(around_strips, field, {.part = none}); }),
               Contains("none.step"));
}

TEST_CASE("closed curves get three edges at least, however long lengths are") {
    const ScratchDirectory folder;
    const double h = GENERATE(5, 30, 1000);
    Part part;
    part.cad = folder.path() / "part.brep";
    in_gmsh_session(1, [&] {
        gmsh::model::occ::addCylinder(100, 0, 0, 0, 0, 30, 1);
        gmsh::model::occ::synchronize();
        gmsh::write(part.cad.string());
    });
    const FormulaField field([&](const Point&) { return Metric::isotropic(h); });
    const MeshRun run =
        mesh_with_gmsh(around_strips, field, {.part = std::make_shared<const Part>(part)});
    // A prism over an equilateral triangle has 0.41 of the volume of its cylinder.
    CHECK(volume(run.mesh) > 0.4 * M_PI * 30);
}

TEST_CASE("a .msh file holds the mesh, as Gmsh reads it") {
    const ScratchDirectory folder;
    TetMesh mesh = kuhn_mesh(2);
    mesh.triangles = {{0, 1, 4}, {0, 3, 4}};
    const auto path = folder.path() / "box.msh";
    write_msh(path, mesh);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);

    std::vector<std::size_t> corners;
    TetMesh read;
    in_gmsh_session(1, [&] {
        gmsh::open(path.string());
        std::vector<std::size_t> tags;
        std::vector<double> x, unused;
        gmsh::model::mesh::getNodes(tags, x, unused);
        read.vertices.resize(tags.size());
        for (std::size_t i = 0; i < tags.size(); ++i) {
            read.vertices.at(tags[i] - 1) = Point(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
        }
        tags.clear();
        gmsh::model::mesh::getElementsByType(4, tags, corners);
        for (std::size_t i = 0; i + 3 < corners.size(); i += 4) {
            Tetrahedron& tet = read.tets.emplace_back();
            for (std::size_t k = 0; k < 4; ++k)
                tet[k] = static_cast<VertexIndex>(corners[i + k] - 1);
        }
        tags.clear();
        corners.clear();
        gmsh::model::mesh::getElementsByType(2, tags, corners);
    });
    CHECK(read.vertices == mesh.vertices);
    CHECK(read.tets == mesh.tets);
    CHECK(corners == std::vector<std::size_t>{1, 2, 5, 1, 4, 5});

    CHECK_THAT(error_of([&] { write_msh(folder.path() / "none" / "box.msh", mesh); }),
               Contains("box.msh"));
}

}  // namespace controlspace::gmsh_mesher_test
