// SPDX-License-Identifier: Apache-2.0
// Files of lengths for meshers, read back by readers of our own that follow the formats'
// descriptions. Gmsh, TetGen and Netgen themselves read them in tests/mesh and tests/cli.
#include "io/text/size_files.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>

#include "controlspace/space/catalogue.h"
#include "files/text_file.h"
#include "geometry/random_fractions.h"
#include "io/text/bisected_box.h"
#include "io/text/cells.h"
#include "sources/files.h"

namespace controlspace::size_files_test {

using Catch::Matchers::Contains;

namespace {

const Box domain{Point(-1, -1, -1), Point(1, 2, 0.5)};

std::unique_ptr<ControlSpace> made(const char* structure, const Metric& finest) {
    const auto builder = find_entry(tree_catalogue(), structure)
                             ->make({.domain = domain, .finest_length = 0.05, .ratio = 1.25});
    builder->insert(std::vector<PointSource>{{{0.31, 0.42, 0.13}, finest},
                                             {{-0.7, 1.1, -0.6}, Metric::isotropic(0.1)}});
    builder->grade({.ratio = 1.25});
    return builder->build();
}
std::unique_ptr<ControlSpace> made() { return made("K_oV", Metric::isotropic(0.05)); }

std::vector<Point> random_places(std::size_t count) {
    RandomFractions random(7);
    std::vector<Point> x;
    for (std::size_t i = 0; i < count; ++i) {
        const double a = random(), b = random(), c = random();
        x.push_back(domain.low + Vector(a, b, c).cwiseProduct(domain.edges()));
    }
    return x;
}

double length_at(const ControlSpace& space, const Point& x) {
    double length = 0;
    space.sample_lengths({&x, 1}, {&length, 1});
    return length;
}

double factor(double a, double b) { return std::max(a / b, b / a); }

/// JIGSAW's reader of a grid in three dimensions: lines KEY=NUMBER;NUMBER and what they announce,
/// values in single precision, y fastest and z slowest; trilinear, and constant beyond the grid.
struct JigsawGrid {
    std::array<std::vector<double>, 3> x;
    std::vector<float> values;

    explicit JigsawGrid(const std::string& text) {
        std::istringstream in(text);
        std::string line, head;
        std::map<std::string, std::string> heads;
        while (std::getline(in, line)) {
            if (line.empty() || line[0] == '#') continue;
            const std::size_t equals = line.find('='), semicolon = line.find(';');
            REQUIRE(equals != line.npos);
            const std::string key = line.substr(0, equals);
            if (key == "COORD") {
                auto& axis = x.at(std::stoul(line.substr(equals + 1)) - 1);
                axis.resize(std::stoul(line.substr(semicolon + 1)));
                for (double& coordinate : axis) in >> coordinate;
            } else if (key == "VALUE") {
                CHECK(line.substr(semicolon) == ";1");
                values.resize(std::stoul(line.substr(equals + 1)));
                for (float& value : values) in >> value;
            } else {
                heads[key] = line.substr(equals + 1);
                continue;
            }
            REQUIRE(in);
            std::getline(in, line);
        }
        CHECK(heads["MSHID"] == "3;EUCLIDEAN-GRID");
        CHECK(heads["NDIMS"] == "3");
        REQUIRE(values.size() == x[0].size() * x[1].size() * x[2].size());
    }

    double operator()(const Point& p) const {
        std::array<std::size_t, 3> i{};
        std::array<double, 3> t{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double c = std::clamp(p[static_cast<Axis>(a)], x[a].front(), x[a].back());
            const auto above = std::upper_bound(x[a].begin(), x[a].end() - 1, c);
            i[a] = static_cast<std::size_t>(above - x[a].begin()) - 1;
            t[a] = (c - x[a][i[a]]) / (x[a][i[a] + 1] - x[a][i[a]]);
        }
        double sum = 0;
        for (std::size_t c = 0; c < 8; ++c) {
            const std::size_t dx = c & 1, dy = c >> 1 & 1, dz = c >> 2;
            const double weight = (dx != 0 ? t[0] : 1 - t[0]) * (dy != 0 ? t[1] : 1 - t[1]) *
                                  (dz != 0 ? t[2] : 1 - t[2]);
            const std::size_t node = ((i[2] + dz) * x[0].size() + i[0] + dx) * x[1].size() + i[1];
            sum += weight * static_cast<double>(values[node + dy]);
        }
        return sum;
    }
};

template <class T>
std::vector<T> numbers(const std::string& bytes, std::size_t from, std::size_t count) {
    std::vector<T> x(count);
    REQUIRE(bytes.size() >= from + count * sizeof(T));
    std::memcpy(x.data(), bytes.data() + from, count * sizeof(T));
    return x;
}

std::vector<double> words(const std::filesystem::path& path) {
    std::istringstream in(read_text_file(path));
    std::vector<double> all;
    for (double x = 0; in >> x;) all.push_back(x);
    return all;
}

}  // namespace

TEST_CASE("a Structured grid has origin, steps, counts, and lengths with z fastest") {
    const ScratchDirectory folder;
    const auto path = folder.path() / "f.structured";
    const auto space = made();
    const SizeFile written = write_gmsh_structured(path, *space, 31);
    const std::string bytes = read_binary_file(path);
    const auto place = numbers<double>(bytes, 0, 6);
    const auto counts = numbers<int>(bytes, 48, 3);
    CHECK(counts == std::vector<int>{21, 31, 16});
    REQUIRE(bytes.size() == 60 + 8 * written.count);
    const auto lengths = numbers<double>(bytes, 60, written.count);
    for (int i = 0; i < 21; i += 5) {
        for (int j = 0; j < 31; j += 6) {
            for (int k = 0; k < 16; ++k) {
                const Point x(place[0] + i * place[3], place[1] + j * place[4],
                              place[2] + k * place[5]);
                const int at = (i * 31 + j) * 16 + k;
                REQUIRE(lengths[static_cast<std::size_t>(at)] == Approx(length_at(*space, x)));
            }
        }
    }
    CHECK(place[1] + 30 * place[4] == Approx(domain.high.y()));
}

TEST_CASE("JIGSAW's grid answers as the field, within what trilinear steps carry") {
    const ScratchDirectory folder;
    const auto path = folder.path() / "f.msh";
    const auto space = made();
    double last = std::numeric_limits<double>::infinity();
    for (const int samples : {17, 65}) {
        const SizeFile written = write_jigsaw_grid(path, *space, samples);
        const JigsawGrid grid(read_text_file(path));
        std::vector<double> factors;
        for (const Point& x : random_places(1000)) {
            factors.push_back(factor(grid(x), length_at(*space, x)));
        }
        std::ranges::sort(factors);
        // The report is the 99 % of as many other places: within 13 ranks of it, three standard
        // deviations of the difference of two binomial numbers of 10.
        CHECK(*written.within >= factors[989 - 14]);
        CHECK(*written.within <= factors.back());
        CHECK(factors[989] < last);
        last = factors[989];
    }
}

TEST_CASE("at its nodes, JIGSAW's grid is the field in single precision") {
    const ScratchDirectory folder;
    const auto space = made();
    write_jigsaw_grid(folder.path() / "f.msh", *space, 13);
    const JigsawGrid grid(read_text_file(folder.path() / "f.msh"));
    for (const double y : grid.x[1]) {
        const Point x(grid.x[0][2], y, grid.x[2][5]);
        CHECK(grid(x) == Approx(length_at(*space, x)).epsilon(1e-6));
    }
}

TEST_CASE("a bisected box is filled by tetrahedra that share whole faces") {
    const Box boxes[] = {
        domain, {Point::Zero(), Point::Ones()}, {Point(3, 0, 0), Point(3.2, 2, 0.1)}};
    const Box box = boxes[GENERATE(0, 1, 2)];
    BisectedBox mesh(box);
    RandomFractions random(3);
    std::vector<Point> places;
    for (int i = 0; i < 40; ++i) {
        const double a = random(), b = random(), c = random();
        const Point x = box.low + Vector(a, b, c).cwiseProduct(box.edges());
        const double size = std::pow(0.5, 1 + i % 6);
        mesh.refine_to({x, x + size * box.edges()}, x);
        places.push_back(x);
    }
    mesh.close();
    mesh.refine({mesh.leaves()[3]});
    mesh.close();
    double volume = 0;
    std::map<std::array<std::uint32_t, 3>, int> faces;
    for (const std::size_t t : mesh.leaves()) {
        auto c = mesh.corners(t);
        const Point a = mesh.points()[c[0]];
        const Vector u = mesh.points()[c[1]] - a, v = mesh.points()[c[2]] - a,
                     w = mesh.points()[c[3]] - a;
        const double six = std::abs(u.dot(v.cross(w)));
        REQUIRE(six > 0);
        volume += six / 6;
        std::ranges::sort(c);
        for (std::size_t left_out = 0; left_out < 4; ++left_out) {
            std::array<std::uint32_t, 3> face{};
            for (std::size_t i = 0, n = 0; i < 4; ++i) {
                if (i != left_out) face[n++] = c[i];
            }
            ++faces[face];
        }
    }
    CHECK(volume == Approx(box.edges().prod()));
    for (const auto& [face, count] : faces) {
        if (count == 2) continue;
        REQUIRE(count == 1);  // on one side of the box
        bool is_outside = false;
        for (Axis a = 0; a < 3; ++a) {
            for (const double side : {box.low[a], box.high[a]}) {
                is_outside = is_outside || std::ranges::all_of(face, [&](std::uint32_t i) {
                                 return mesh.points()[i][a] == side;
                             });
            }
        }
        REQUIRE(is_outside);
    }
    for (const Point& x : places) {
        const auto place = mesh.place_of(x);
        Point back = Point::Zero();
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(place.weights[i] >= 0);
            back += place.weights[i] * mesh.points()[mesh.corners(place.tetrahedron)[i]];
        }
        CHECK((back - x).norm() < 1e-12);
    }
}

TEST_CASE("TetGen's background mesh is three files that belong together") {
    const ScratchDirectory folder;
    const auto base = folder.path() / "part.b";
    const auto space = made();
    const SizeFile written = write_tetgen_background(base, *space);
    const auto node = words(base.string() + ".node"), ele = words(base.string() + ".ele"),
               mtr = words(base.string() + ".mtr");
    const auto count = static_cast<double>(written.count);
    REQUIRE(node.size() == 4 + 4 * written.count);
    REQUIRE(mtr.size() == 2 + written.count);
    CHECK((node[0] == count && node[1] == 3 && mtr[0] == count && mtr[1] == 1));
    REQUIRE(static_cast<double>(ele.size()) == 3 + 5 * ele[0]);
    for (std::size_t i = 0; i < written.count; i += 17) {
        const double* row = &node[4 + 4 * i];
        REQUIRE(row[0] == static_cast<double>(i + 1));
        REQUIRE(mtr[2 + i] == Approx(length_at(*space, Point(row + 1))).epsilon(1e-12));
    }
    CHECK(*std::max_element(ele.begin() + 3, ele.end()) <= std::max(count, ele[0]));
    CHECK(mtr.size() > 2 + space->footprint().control_nodes);
}

TEST_CASE("Netgen's sizes are as dense as they are small, the smallest first") {
    const ScratchDirectory folder;
    const auto space = made();
    const SizeFile written = write_netgen_sizes(folder.path() / "f.msz", *space);
    const auto all = words(folder.path() / "f.msz");
    REQUIRE(all.size() == 2 + 4 * written.count);
    CHECK(all.front() == static_cast<double>(written.count));
    CHECK(all.back() == 0);  // no lines
    double last = 0;
    double elements = 0;
    for (std::size_t i = 0; i < written.count; ++i) {
        const double* row = &all[1 + 4 * i];
        REQUIRE(row[3] == length_at(*space, Point(row)));
        REQUIRE(row[3] >= last);
        last = row[3];
        elements += row[3] * row[3] * row[3];
    }
    // Each stands for a box with no edge longer than half its length.
    CHECK(elements >= 8 * domain.edges().prod());
}

TEST_CASE("of tensors, files of lengths hold the smallest, and say so") {
    const ScratchDirectory folder;
    const Metric thin{0.05, 0.4, 0.4, 0, 0, 0};
    const auto space = made("K_oV", thin);
    const SizeFile grid = write_gmsh_structured(folder.path() / "f.structured", *space, 5);
    CHECK(grid.has_tensors);
    CHECK(write_netgen_sizes(folder.path() / "f.msz", *space).has_tensors);
    CHECK(write_tetgen_background(folder.path() / "f.b", *space).has_tensors);
    CHECK_FALSE(write_gmsh_structured(folder.path() / "g.structured", *made(), 5).has_tensors);
    const auto first = numbers<double>(read_binary_file(folder.path() / "f.structured"), 60, 1);
    CHECK(first[0] == length_at(*space, domain.low));
}

TEST_CASE("files of lengths of a plane") {
    const ScratchDirectory folder;
    const Box plane{{0, 0, 0.5}, {2, 1, 0.5}};
    const auto builder = find_entry(tree_catalogue(), "K_oV")->make({.domain = plane});
    builder->insert(std::vector<PointSource>{{{0.3, 0.4, 0.5}, Metric::isotropic(0.05)}});
    builder->grade({.ratio = 1.25});
    const auto space = builder->build();
    // Two layers of nodes, of the same lengths.
    const SizeFile written = write_gmsh_structured(folder.path() / "f.structured", *space, 81);
    CHECK(written.within.value() < 1.1);
    const std::string bytes = read_binary_file(folder.path() / "f.structured");
    CHECK(numbers<double>(bytes, 0, 6) == std::vector<double>{0, 0, 0.5, 0.025, 0.025, 0.025});
    CHECK(numbers<int>(bytes, 48, 3) == std::vector<int>{81, 41, 2});
    const auto lengths = numbers<double>(bytes, 60, written.count);
    for (std::size_t i = 0; i < lengths.size(); i += 2) CHECK(lengths[i] == lengths[i + 1]);
    CHECK(write_jigsaw_grid(folder.path() / "f.msh", *space, 81).within == written.within);
    CHECK_THAT(read_text_file(folder.path() / "f.msh"),
               Contains("NDIMS=2\n") && Contains("VALUE=3321;1\n"));
    CHECK(write_netgen_sizes(folder.path() / "f.msz", *space).count > 10);
    CHECK_THAT(error_of([&] { write_tetgen_background(folder.path() / "f.b", *space); }),
               Contains("is a plane"));
}

TEST_CASE("files of lengths that cannot be written leave none") {
    const ScratchDirectory folder;
    const auto space = made();
    for (const int samples : {-1, 1, 513}) {
        CHECK_THAT(error_of([&] { write_jigsaw_grid(folder.path() / "f.msh", *space, samples); }),
                   Contains("give 2 to 512"));
    }
    CHECK_THAT(error_of([&] { write_tetgen_background(folder.path() / "no" / "f.b", *space); }),
               Contains("cannot write"));
    CHECK(std::filesystem::is_empty(folder.path()));
}

}  // namespace controlspace::size_files_test
