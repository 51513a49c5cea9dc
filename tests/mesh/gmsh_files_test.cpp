// SPDX-License-Identifier: Apache-2.0
// Files that Gmsh itself wrote.
#include <gmsh.h>

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>
#include <set>

#include "case_of_each.h"
#include "controlspace/sources/riemannian.h"
#include "controlspace/space/catalogue.h"
#include "files/text_file.h"
#include "gmsh/gmsh_session.h"
#include "io/text/msh.h"
#include "io/text/pos.h"
#include "sources/files.h"

namespace controlspace::gmsh_files_test {

using Catch::Matchers::Contains;

namespace {

Metric metric_of(const Point& p) {
    return {0.3 + 0.05 * p.x(), 0.4 + 0.05 * p.y(), 0.5 + 0.05 * p.z(), 0.02, -0.03, 0.05};
}

std::vector<double> row_of(const Point& p, bool sizes) {
    if (sizes) return {metric_of(p).xx};
    const Metric t = to_riemannian(metric_of(p));
    return {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz};
}

/// Tetrahedra of a box, in the session of Gmsh, to be written so.
void mesh_box(bool binary, double version) {
    gmsh::option::setNumber("Mesh.MshFileVersion", version);
    gmsh::option::setNumber("Mesh.Binary", binary ? 1 : 0);
    gmsh::option::setNumber("Mesh.MeshSizeMax", 0.4);
    gmsh::option::setNumber("Mesh.SaveAll", 1);
    gmsh::model::occ::addBox(0, 0, 0, 1, 1, 2);
    gmsh::model::occ::synchronize();
    gmsh::model::mesh::generate(3);
}

/// A box meshed by Gmsh, with data at its nodes, as Gmsh saves it.
void write_by_gmsh(const std::filesystem::path& msh, bool sizes, bool binary, int views = 1,
                   double version = 4.1) {
    in_gmsh_session(1, [&] {
        mesh_box(binary, version);
        std::vector<std::size_t> tags;
        std::vector<double> x, unused;
        gmsh::model::mesh::getNodes(tags, x, unused);
        std::vector<std::vector<double>> rows;
        for (std::size_t i = 0; i < tags.size(); ++i)
            rows.push_back(row_of(Point(&x[3 * i]), sizes));
        gmsh::write(msh.string());
        std::string model;
        gmsh::model::getCurrent(model);
        for (int i = 0; i < views; ++i) {
            const int view = gmsh::view::add("view " + std::to_string(i));
            gmsh::view::addModelData(view, 0, model, "NodeData", tags, rows);
            gmsh::view::write(view, msh.string(), true);
        }
    });
}

/// The mesh, and then a view of data of the elements `tags`.
void write_view(const std::filesystem::path& path, const std::string& name, const std::string& type,
                const std::vector<std::size_t>& tags, const std::vector<std::vector<double>>& rows,
                int components = -1) {
    gmsh::write(path.string());
    std::string model;
    gmsh::model::getCurrent(model);
    const int view = gmsh::view::add(name);
    gmsh::view::addModelData(view, 0, model, type, tags, rows, 0, components);
    gmsh::view::write(view, path.string(), true);
}

/// Sources that ask for what metric_of says.
void check_sources(const std::vector<PointSource>& sources, bool sizes) {
    for (const PointSource& s : sources) {
        const Metric m = metric_of(s.position);
        const Metric expected = sizes ? Metric::isotropic(m.xx) : m;
        REQUIRE(s.metric.matrix().isApprox(expected.matrix(), 1e-6));
    }
}

std::string altered(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("data at the nodes of a mesh by Gmsh are sources") {
    const ScratchDirectory folder;
    const bool sizes = GENERATE(true, false);
    const bool binary = GENERATE(false, true);
    const auto path = folder.path() / "box.msh";
    write_by_gmsh(path, sizes, binary, 2, GENERATE(4.1, 2.2));
    CHECK_THAT(error_of([&] { read_msh_sources(path); }),
               Contains("2 of its views can be meant: name one of 'view 0', 'view 1'"));
    const auto sources = read_msh_sources(path, {.array = "view 1"});
    CHECK(sources.size() > 50);
    check_sources(sources, sizes);
}

TEST_CASE("data of the elements of a mesh by Gmsh are sources at their centres") {
    const ScratchDirectory folder;
    const bool sizes = GENERATE(true, false);
    const bool binary = GENERATE(false, true);
    const int order = GENERATE(1, 2);
    const double version = GENERATE(4.1, 2.2);
    const auto path = folder.path() / "box.msh";
    std::size_t count = 0;
    in_gmsh_session(1, [&] {
        mesh_box(binary, version);
        gmsh::model::mesh::setOrder(order);
        std::vector<std::size_t> tags, nodes;
        gmsh::model::mesh::getElementsByType(order == 1 ? 4 : 11, tags, nodes);
        count = tags.size();
        const std::size_t each = nodes.size() / count;
        std::vector<std::vector<double>> rows;
        for (std::size_t i = 0; i < count; ++i) {
            Point sum = Point::Zero();
            for (std::size_t k = 0; k < each; ++k) {
                std::vector<double> x, unused;
                gmsh::model::mesh::getNode(nodes[each * i + k], x, unused);
                sum += Point(x.data());
            }
            rows.push_back(row_of(sum / static_cast<double>(each), sizes));
        }
        write_view(path, "of cells", "ElementData", tags, rows);
    });
    const auto sources = read_msh_sources(path);
    CHECK(sources.size() == count);
    CHECK(count > 100);
    check_sources(sources, sizes);
    CHECK(read_msh_sources(path, {.array = "of cells"}) == sources);
    CHECK_THAT(error_of([&] { read_msh_sources(path, {.array = "other"}); }),
               Contains("'of cells'"));
    if (binary || version < 4) return;
    const std::string text = read_text_file(path);
    // Gmsh writes the mesh twice: before the view and with it.
    const auto error = [&](const std::string& from, const std::string& to) {
        std::string all = text;
        std::size_t at = all.find(from);
        REQUIRE(at != std::string::npos);
        for (; at != std::string::npos; at = all.find(from, at + to.size())) {
            all.replace(at, from.size(), to);
        }
        std::ofstream(path, std::ios::binary) << all;
        return error_of([&] { read_msh_sources(path); });
    };
    CHECK_THAT(error("Elements\n", "Pixels\n"), Contains("but no $Elements"));
    const std::string block = order == 1 ? "\n3 1 4 " : "\n3 1 11 ";
    CHECK_THAT(error(block, "\n3 1 99 "), Contains("elements of the unknown type 99"));
    CHECK_THAT(error(block + std::to_string(count), block + "2000000000"),
               Contains("Elements 2000"));
    CHECK_THAT(error(block + std::to_string(count), block + "1"), Contains("box.msh"));
}

TEST_CASE("data at the corners of elements by Gmsh are sources there") {
    const ScratchDirectory folder;
    const bool sizes = GENERATE(true, false);
    const bool binary = GENERATE(false, true);
    const double version = GENERATE(4.1, 2.2);
    const auto path = folder.path() / "box.msh";
    std::size_t nodes_of_tets = 0;
    in_gmsh_session(1, [&] {
        mesh_box(binary, version);
        std::vector<std::size_t> tags, nodes;
        gmsh::model::mesh::getElementsByType(4, tags, nodes);
        std::vector<std::vector<double>> rows(tags.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            std::vector<double> x, unused;
            gmsh::model::mesh::getNode(nodes[i], x, unused);
            const auto row = row_of(Point(x.data()), sizes);
            rows[i / 4].insert(rows[i / 4].end(), row.begin(), row.end());
        }
        nodes_of_tets = std::set(nodes.begin(), nodes.end()).size();
        write_view(path, "of corners", "ElementNodeData", tags, rows, sizes ? 1 : 9);
    });
    const auto sources = read_msh_sources(path);
    CHECK(sources.size() == nodes_of_tets);
    check_sources(sources, sizes);
}

TEST_CASE("list views that Gmsh saved are sources") {
    const ScratchDirectory folder;
    const std::string type = GENERATE("SP", "TP", "SS", "TS");
    const bool sizes = type[0] == 'S';
    const std::vector<Point> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::size_t used = type[1] == 'P' ? 1 : 4;
    std::vector<double> data;
    for (Axis a = 0; a < 3; ++a) {  // all x, then all y, then all z
        for (std::size_t i = 0; i < used; ++i) data.push_back(corners[i][a]);
    }
    for (std::size_t i = 0; i < used; ++i) {
        const auto row = row_of(corners[i], sizes);
        data.insert(data.end(), row.begin(), row.end());
    }
    const auto path = folder.path() / "list.pos";
    in_gmsh_session(1, [&] {
        const int view = gmsh::view::add("a list");
        gmsh::view::addListData(view, type, 1, data);
        gmsh::view::write(view, path.string());
    });
    CAPTURE(type, read_text_file(path));
    const auto sources = read_pos_sources(path);
    REQUIRE(sources.size() == used);
    check_sources(sources, sizes);
}

TEST_CASE("list views that are written here are read by Gmsh") {
    const ScratchDirectory folder;
    const Point p(0.5, 0.25, 2);
    write_pos_sources(folder.path() / "a.pos", std::vector<PointSource>{{p, metric_of(p)}});
    std::vector<std::string> types;
    std::vector<int> counts;
    std::vector<std::vector<double>> data;
    in_gmsh_session(1, [&] {
        gmsh::merge((folder.path() / "a.pos").string());
        std::vector<int> tags;
        gmsh::view::getTags(tags);
        gmsh::view::getListData(tags.at(0), types, counts, data);
    });
    REQUIRE(types == std::vector<std::string>{"TP"});
    std::vector<double> expected{p.x(), p.y(), p.z()};
    for (const double x : row_of(p, false)) expected.push_back(x);
    REQUIRE(data.at(0).size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) CHECK(data[0][i] == Approx(expected[i]));
}

TEST_CASE("a .msh that lies or breaks off is refused") {
    const ScratchDirectory folder;
    const auto path = folder.path() / "box.msh";
    const auto error = [&](const std::string& bytes) {
        std::ofstream(path, std::ios::binary) << bytes;
        return error_of([&] { read_msh_sources(path); });
    };
    write_by_gmsh(path, true, false);
    const std::string text = read_text_file(path);
    CHECK_THAT(error(altered(text, "4.1 0 8", "4.0 0 8")), Contains("box.msh:2: format '4.0'"));
    CHECK_THAT(error("mesh"), Contains("does not start with $MeshFormat"));
    CHECK_THAT(error(text.substr(0, text.find("$EndNodes"))), Contains("no $NodeData"));
    CHECK_THAT(error(text.substr(0, text.find("$EndNodes") - 200)), Contains("cut off"));
    const std::size_t nodes = text.find("$Nodes\n") + 7;
    const std::size_t line_end = text.find('\n', nodes);
    const auto with_head = [&](const std::string& head) {
        return text.substr(0, nodes) + head + text.substr(line_end);
    };
    CHECK_THAT(error(with_head("27 2000000000 1 2000000000")), Contains("Nodes 2000000"));
    CHECK_THAT(error(with_head("27 -5 1 5")), Contains("'-5' instead of a count"));
    CHECK_THAT(error(with_head("27 3 1 3")), Contains("left"));
    CHECK_THAT(error(with_head("many")), Contains("'many' instead of a count"));
    const std::size_t data = text.find("$NodeData");
    CHECK_THAT(error(text.substr(0, data) +
                     altered(text.substr(data), "\n3\n0\n1\n", "\n3\n0\n1\n2000000000\n")),
               Contains("NodeData 2000000000"));
    CHECK_THAT(error(text.substr(0, data)), Contains("no $NodeData"));

    write_by_gmsh(path, true, true);
    std::string bytes = read_binary_file(path);
    const std::size_t binary_nodes = bytes.find("$Nodes\n") + 7;
    const std::uint64_t lie = 2'000'000'000;
    std::memcpy(&bytes[binary_nodes + 8], &lie, sizeof lie);
    CHECK_THAT(error(bytes), Contains("box.msh, byte ") && Contains("Nodes 2000000"));
    CHECK_THAT(error(bytes.substr(0, binary_nodes + 4)), Contains("the data end within Nodes"));
}

/// The share of random places in `part` where Gmsh, by the first view of the file, is within a
/// factor of the structure along every direction.
double found_by_gmsh(const std::filesystem::path& file, const ControlSpace& space, const Box& part,
                     double factor = 1.01) {
    constexpr int places = 1000;
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    int found = 0;
    in_gmsh_session(1, [&] {
        gmsh::merge(file.string());
        std::vector<int> views;
        gmsh::view::getTags(views);
        for (int i = 0; i < places; ++i) {
            const Vector t(unit(random), unit(random), unit(random));
            const Point p = part.low + t.cwiseProduct(part.edges());
            std::vector<double> v;
            gmsh::view::probe(views.at(0), p.x(), p.y(), p.z(), v);
            if (v.empty()) continue;
            const Eigen::Matrix3d read =
                v.size() == 1 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() / (v[0] * v[0]))
                              : Eigen::Matrix3d::Map(v.data());
            const Eigen::Array3d squares =
                Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d>(
                    read, to_riemannian(sample_at(space, p)).matrix())
                    .eigenvalues();
            if ((squares.log().abs() < 2 * std::log(factor)).all()) ++found;
        }
    });
    return found / double{places};
}

CASE_OF_EACH(entry, tree_catalogue(), "Gmsh answers by a view of cells as the structure does") {
    const ScratchDirectory folder;
    const Box box{Point(-1, -1, -1), Point(1, 2, 1)};
    const auto builder = entry.make({.domain = box, .finest_length = 0.05, .ratio = 1.25});
    builder->insert(std::vector<PointSource>{{{0.31, 0.42, 0.13}, Metric::isotropic(0.05)},
                                             {{-0.7, 1.1, 0.6}, Metric::isotropic(0.1)}});
    builder->grade({.ratio = 1.25});
    const auto space = builder->build();
    const PosCells cells = write_pos_cells(folder.path() / "cells.pos", *space);
    CHECK_FALSE(cells.has_tensors);
    CHECK(cells.count >= space->footprint().cells);
    CHECK(cells.off <= 0.01);
    CHECK(found_by_gmsh(folder.path() / "cells.pos", *space, box) >= 0.99);
    // Not only where the volume is: also where the smallest elements are.
    const Vector near = Vector::Constant(0.06);
    const Point finest(0.31, 0.42, 0.13);
    const Box beside{finest - near, finest + near};
    CHECK(found_by_gmsh(folder.path() / "cells.pos", *space, beside, 1.05) >= 0.99);
}

TEST_CASE("Gmsh finds the tensors of a view of cells as the structure has them") {
    const ScratchDirectory folder;
    const Box box{Point::Zero(), Point(1, 2, 1)};
    const std::vector<PointSource> sources{
        {{0.3, 0.4, 0.5}, metric_from_frame({0.1, 0.2, 0.4}, Eigen::Matrix3d::Identity())},
        {{0.8, 1.5, 0.2}, metric_of(Point::Zero())}};
    const auto builder = find_entry(tree_catalogue(), "K_oV")->make({.domain = box, .ratio = 1.25});
    builder->insert(sources);
    builder->grade({.ratio = 1.25});
    const auto space = builder->build();
    const auto file = folder.path() / "cells.pos";
    const PosCells cells = write_pos_cells(file, *space);
    CHECK(cells.has_tensors);
    CHECK(cells.off <= 0.01);
    CHECK(found_by_gmsh(file, *space, box) >= 0.99);
}

}  // namespace controlspace::gmsh_files_test
