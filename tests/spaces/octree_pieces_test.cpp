// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/octree_pieces.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <string>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/space/make_control_space.h"
#include "geometry/random_fractions.h"
#include "sources/files.h"

namespace controlspace::octree_pieces_test {

using Catch::Matchers::Contains;

namespace {

const Box domain{Point(-1, 2, 0), Point(1, 4, 2)};

std::unique_ptr<ControlSpace> tree_of(const char* structure, double h) {
    const std::vector<PointSource> sources{{Point(0.3, 2.4, 0.6), Metric::isotropic(h)},
                                           {Point(-0.7, 3.5, 1.2), Metric::isotropic(2 * h)}};
    return make_control_space(structure, sources, {.domain = domain, .l_min = 1});
}

// Octants: of the first with eight of its own.
std::vector<Box> octants_of(const Box& box) {
    std::vector<Box> parts;
    for (int i = 0; i < 8; ++i) {
        const Point a = corner(box, i), c = box.centre();
        parts.push_back({a.cwiseMin(c), a.cwiseMax(c)});
    }
    return parts;
}

// Two pieces whose fields differ, so that it shows which of them answers.
struct TwoPieces {
    explicit TwoPieces(const char* structure = "K_oL")
        : spaces{tree_of(structure, 0.1), tree_of("K_oV", 0.17)} {
        const std::vector<Box> large = octants_of(domain), small = octants_of(large[0]);
        octants[0] = {small.begin(), small.begin() + 5};
        octants[1] = {small.begin() + 5, small.end()};
        for (std::size_t i = 1; i < 8; ++i) octants[i < 4 ? 0 : 1].push_back(large[i]);
        std::vector<OctreePiece> pieces;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto file = scratch / ("field_" + std::to_string(k) + ".ctrl");
            save_control_space(file, *spaces[k]);
            pieces.push_back({file, octants[k]});
        }
        write_octree_pieces(index, domain, pieces);
    }
    // A face between two octants belongs to the low side.
    std::size_t piece_at(const Point& x) const {
        for (std::size_t k = 0; k < 2; ++k) {
            for (const Box& box : octants[k]) {
                bool holds = box.contains(x);
                for (Axis a = 0; a < 3; ++a) {
                    holds = holds && (x[a] > box.low[a] || box.low[a] == domain.low[a]);
                }
                if (holds) return k;
            }
        }
        return 2;
    }
    std::string error_after(const std::string& from, const std::string& to) const {
        std::string text = file_text(index);
        const std::size_t at = text.find(from);
        REQUIRE(at != text.npos);
        const auto changed = scratch.file("changed.pctrl", text.replace(at, from.size(), to));
        return error_of([&] { load_octree_pieces(changed, structures()); });
    }

    ScratchDirectory scratch{"pieces"};
    std::filesystem::path index = scratch / "field.pctrl";
    std::unique_ptr<ControlSpace> spaces[2];
    std::vector<Box> octants[2];
};

std::vector<Point> places(int n) {
    RandomFractions fraction(5);
    std::vector<Point> x;
    for (int i = 0; i < n; ++i) {
        Point p;
        for (Axis a = 0; a < 3; ++a) {
            p[a] = domain.low[a] + (1.2 * fraction() - 0.1) * domain.edges()[a];
        }
        // On faces between octants, and on the domain's.
        if (i % 3 == 0) p[i % 9 / 3] = domain.centre()[i % 9 / 3];
        if (i % 7 == 0) p[i % 2] = domain.high[i % 2];
        x.push_back(p);
    }
    return x;
}

}  // namespace

TEST_CASE("pieces of an octree answer in their octants, to the bit") {
    const TwoPieces made(GENERATE("K_oL", "K_oV"));
    const auto space = load_octree_pieces(made.index, structures());
    CHECK(space->domain() == domain);
    const std::vector<Point> x = places(3000);
    std::vector<Metric> metrics(x.size());
    std::vector<double> lengths(x.size());
    space->sample(x, metrics);
    space->sample_lengths(x, lengths);
    int of_pieces[2] = {0, 0};
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Point inside = nearest_in(domain, x[i]);
        const std::size_t k = made.piece_at(inside);
        REQUIRE(k < 2);
        ++of_pieces[k];
        const ControlSpace& piece = *made.spaces[k];
        CHECK(metrics[i] == piece.metric_at(inside));
        CHECK(lengths[i] == piece.length_at(inside));
        CHECK(space->metric_at(x[i]) == metrics[i]);
        CHECK(space->length_at(x[i]) == lengths[i]);
        CHECK(space->cell_at(x[i]) == piece.cell_at(inside));
    }
    CHECK(of_pieces[0] > 100);
    CHECK(of_pieces[1] > 100);
    const Footprint all = space->footprint();
    CHECK(all.cells == made.spaces[0]->footprint().cells + made.spaces[1]->footprint().cells);
    CHECK(all.bytes_payload > 0);
}

TEST_CASE("of a region only the pieces in it are read") {
    const TwoPieces made;
    std::filesystem::remove(made.scratch / "field_1.ctrl");
    CHECK_THAT(error_of([&] { load_octree_pieces(made.index, structures()); }),
               Contains("field_1.ctrl"));
    const Box& octant = made.octants[0].back();
    Box region{octant.centre() - octant.edges() / 4, octant.centre()};
    region.low.z() -= 10;  // partly outside
    const auto part = load_octree_pieces(made.index, structures(), region);
    CHECK(part->domain() == Box{region.low.cwiseMax(domain.low), region.high});
    for (const Point& x : places(500)) {
        CHECK(part->length_at(x) == made.spaces[0]->length_at(nearest_in(part->domain(), x)));
    }
    const Box outside{domain.high + Vector::Constant(1), domain.high + Vector::Constant(2)};
    CHECK_THAT(error_of([&] { load_octree_pieces(made.index, structures(), outside); }),
               Contains("has nothing in"));
}

TEST_CASE("an index of pieces that does not fit is refused") {
    const TwoPieces made;
    CHECK_THAT(made.error_after("pieces 1", "pieces 2"), Contains("no index of pieces"));
    CHECK_THAT(made.error_after("-1,2,0,1,4,2", "-1,2,0,1,4,3"), Contains("no octant"));
    CHECK_THAT(made.error_after("-1,2,0,1,4,2", "-1,2,0,1,4,nan"), Contains("2"));
    CHECK_THAT(made.error_after("field_0", "../field_0"), Contains("beside the index"));
    CHECK_THAT(made.error_after("field_0.ctrl ", ""), Contains("beside the index"));
    CHECK_THAT(made.error_after("piece field_0.ctrl", "field_0.ctrl"), Contains("no piece"));
    CHECK_THAT(made.error_after("-1,2,0,1,4,2", "-1,2,0,1,x,2"), Contains("no coordinate"));
    const std::string text = file_text(made.index);
    const std::string last = text.substr(text.rfind('\n', text.size() - 2) + 1);
    CHECK_THAT(made.error_after(last, ""), Contains("leave a part"));
    CHECK_THAT(made.error_after(last, last + last), Contains("twice"));
    CHECK_THAT(error_of([&] { load_octree_pieces(made.scratch / "none.pctrl", structures()); }),
               Contains("none.pctrl"));
    // A piece of another run, and one of another domain.
    save_control_space(made.scratch / "field_0.ctrl", *made.spaces[1]);
    CHECK_THAT(error_of([&] { load_octree_pieces(made.index, structures()); }),
               Contains("of another run"));
    const std::vector<PointSource> one{{Point(0, 0, 0), Metric::isotropic(0.1)}};
    const auto other =
        make_control_space("K_oL", one, {.domain = {Point(-1, -1, -1), Point(1, 1, 1)}});
    save_control_space(made.scratch / "field_0.ctrl", *other);
    write_octree_pieces(made.index, domain,
                        std::vector<OctreePiece>{{made.scratch / "field_0.ctrl", {domain}}});
    CHECK_THAT(error_of([&] { load_octree_pieces(made.index, structures()); }),
               Contains("is not that of"));
    CHECK_THAT(error_of([&] {
                   write_octree_pieces(made.index, domain,
                                       std::vector<OctreePiece>{{made.scratch / "none.ctrl", {}}});
               }),
               Contains("none.ctrl"));
    CHECK(file_text(made.index).find("field_0.ctrl") != std::string::npos);
}

}  // namespace controlspace::octree_pieces_test
