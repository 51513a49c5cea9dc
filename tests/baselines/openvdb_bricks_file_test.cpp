// SPDX-License-Identifier: Apache-2.0
// The .vdb of openvdb-bricks: what this program and others find in it.
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "baselines/fixtures.h"
#include "baselines/octree_files.h"
#include "baselines/octree_scenes.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/control_space_file.h"
#include "scratch_directory.h"
#include "space/sealed_vdb.h"

namespace controlspace::openvdb_bricks_file_test {

using octree_scenes::Scene;

namespace {

// Anywhere, at sources, and at corners of cells.
std::vector<Point> places(const Scene& scene, const ControlSpace& space) {
    std::vector<Point> x = random_points(scene.domain, 20000, 1);
    for (const PointSource& source : scene.sources) x.push_back(source.position);
    for (std::size_t i = 0; i < 200; ++i) {
        const Box cell = space.cell_at(x[i]).value();
        for (int c = 0; c < 8; ++c) x.push_back(corner(cell, c));
    }
    return x;
}

ControlNodes nodes(const ControlSpace& space) {
    return control_nodes(space, Neighbourhood::faces).value();
}

// The grids of a file, by levels.
std::vector<openvdb::FloatGrid::Ptr> grids_of(const std::filesystem::path& path) {
    openvdb::io::File file(path.string());
    file.open(false);
    std::vector<openvdb::FloatGrid::Ptr> grids;
    for (auto name = file.beginName(); name != file.endName(); ++name) {
        CHECK_THAT(name.gridName(), Catch::StartsWith("length_"));
        grids.push_back(openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name.gridName())));
        REQUIRE(grids.back());
    }
    return grids;
}

}  // namespace

TEST_CASE("a .vdb of bricks answers their floats to the bit") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2, 3));
    CAPTURE(scene.domain);
    const auto builder = scene.builder("openvdb-bricks", 0.2, Precision::floats);
    const auto floats = builder->build({.precision = Precision::floats});
    const std::vector<Point> x = places(scene, *floats);
    const ScratchDirectory folder;
    for (const auto& precision : std::initializer_list<std::optional<Precision>>{
             {}, Precision::doubles, Precision::floats}) {
        save_control_space(folder / "field.vdb", *builder->build({.precision = precision}));
        CHECK(holds_control_space(folder / "field.vdb"));
        const SavedControlSpace saved = open_control_space(folder / "field.vdb", structures());
        CHECK(saved.recipe.structure == "openvdb-bricks");
        CHECK(saved.recipe.precision == Precision::floats);
        CHECK(saved.builder == nullptr);
        CHECK(saved.space->domain() == scene.domain);
        CHECK(sample(*saved.space, x) == sample(*floats, x));
        for (const Point& p : x) REQUIRE(saved.space->cell_at(p) == floats->cell_at(p));
        CHECK(nodes(*saved.space).metrics == nodes(*floats).metrics);
        CHECK(saved.space->footprint().bytes_total() == floats->footprint().bytes_total());
        save_control_space(folder / "again.ctrl", *saved.space);
        const auto again = load_control_space(folder / "again.ctrl", structures());
        CHECK(sample(*again, x) == sample(*floats, x));
    }
}

TEST_CASE("codes of bricks come back from a .vdb as floats, and keep the target") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2));
    CAPTURE(scene.domain);
    constexpr double target = 0.1;
    const Precision precision = GENERATE(Precision::log16, Precision::log8);
    const auto codes =
        scene.builder("openvdb-bricks", target, precision)->build({.precision = precision});
    const ScratchDirectory folder;
    save_control_space(folder / "field.vdb", *codes);
    const auto loaded = load_control_space(folder / "field.vdb", structures());
    // What is decoded at the vertices, in floats.
    const ControlNodes own = nodes(*codes), theirs = nodes(*loaded);
    REQUIRE(own.metrics.size() == theirs.metrics.size());
    for (std::size_t i = 0; i < own.metrics.size(); ++i) {
        REQUIRE(theirs.metrics[i].xx == static_cast<float>(own.metrics[i].xx));
    }
    // Each of two bricks rounds a vertex by half a step at most.
    const auto [shortest, longest] = std::ranges::minmax(own.metrics, {}, &Metric::xx);
    const double steps = precision == Precision::log8 ? 255 : 65535;
    const double step = std::max(std::pow(longest.xx / shortest.xx, 1 / steps), 1.0002);
    double worst = 0, most = 1;
    for (const Point& x : places(scene, *codes)) {
        const double h = loaded->length_at(x);
        most = std::max(most, largest_ratio(codes->metric_at(x), loaded->metric_at(x)));
        worst =
            std::max(worst, nonconformity(Metric::isotropic(h), Metric::isotropic(scene.exact(x))));
    }
    CHECK(most <= step * (1 + 1e-6));
    CHECK(worst <= target);
}

TEST_CASE("other programs find lengths and places in a .vdb of bricks") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2, 3));
    const Box& domain = scene.domain;
    CAPTURE(domain);
    const auto bricks = scene.adapted("openvdb-bricks", 0.2, Precision::floats);
    const ScratchDirectory folder;
    save_control_space(folder / "field.vdb", *bricks);
    const auto grids = grids_of(folder / "field.vdb");
    REQUIRE(grids.size() > 1);
    // The tiny domain's voxels are below what OpenVDB's transforms may be.
    const auto scale_note = grids[0]->getMetadata<openvdb::DoubleMetadata>("scale");
    CHECK((scale_note != nullptr) == (domain.edges().maxCoeff() < 1e-3));
    const double scale = scale_note ? scale_note->value() : 1;
    const double reach = domain.low.cwiseAbs().cwiseMax(domain.high.cwiseAbs()).maxCoeff();
    openvdb::CoordBBox none;
    for (const auto& grid : grids) {
        const auto low = grid->metaValue<openvdb::Vec3d>("domain_low");
        CHECK(Point(low.x(), low.y(), low.z()) == domain.low);
        // Nothing lies outside of the domain, and some level reaches its faces.
        const openvdb::CoordBBox all = grid->evalActiveVoxelBoundingBox();
        const openvdb::Vec3d first = grid->indexToWorld(all.min()),
                             last = grid->indexToWorld(all.max());
        for (Axis a = 0; a < 3; ++a) {
            CHECK(first[a] / scale >= domain.low[a] - 1e-12 * reach);
            CHECK(last[a] / scale <= domain.high[a] + 1e-12 * reach);
        }
    }
    // In the cell of a brick its level's grid has all vertices, and is what is answered.
    for (const Point& p : random_points(domain, 5000, 1)) {
        const Vector edges = bricks->cell_at(p)->edges();
        const auto grid = std::ranges::find_if(grids, [&](const auto& g) {
            // Cells of one size: in the short axes of an oblong box a brick may have fewer.
            const openvdb::Vec3d of_grid = g->voxelSize() / scale;
            bool fits = true;
            for (Axis a = 0; a < 3; ++a) {
                const double ratio = edges[a] / of_grid[static_cast<int>(a)];
                fits = fits && (edges[a] == 0 || std::abs(ratio - std::round(ratio)) < 1e-6);
            }
            const openvdb::Vec3d at =
                g->worldToIndex({scale * p.x(), scale * p.y(), scale * p.z()});
            return fits && g->tree().isValueOn(openvdb::Coord::floor(at)) &&
                   g->tree().isValueOn(
                       openvdb::Coord::floor(at).offsetBy(1, 1, edges.z() > 0 ? 1 : 0));
        });
        REQUIRE(grid != grids.end());
        const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(
            **grid);
        const float h = sampler.wsSample({scale * p.x(), scale * p.y(), scale * p.z()});
        REQUIRE(h / scale == Approx(bricks->length_at(p)).epsilon(1e-4));
    }

    // Written by such a program, it is a picture.
    octree_files::check_is_picture({grids.begin(), grids.end()});
}

TEST_CASE("what is no lengths of bricks is not saved to a .vdb") {
    const ScratchDirectory folder;
    const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .finest_length = 1};
    const auto builder = structure_with_id("openvdb-bricks").make(options);
    builder->insert(sample_sphere({.h = 0.2, .s_a = 2, .s_n = 0.5}));
    for (const auto& precision :
         std::initializer_list<std::optional<Precision>>{{}, Precision::floats}) {
        const auto space = builder->build({.precision = precision});
        const std::string error = error_of([&] { save_control_space(folder / "t.vdb", *space); });
        CHECK_THAT(error, Catch::Contains("tensors") && Catch::Contains(".ctrl"));
        CHECK(std::ranges::count(error, '\n') == 0);
    }
    CHECK_THAT(error_of([&] { save_control_space(folder / "t.vdb", *builder); }),
               Catch::Contains("openvdb-bricks") && Catch::Contains(".ctrl"));
    const Box large{Point(0, 0, 0), Point(1e42, 1e42, 1e42)};
    const auto beyond = structure_with_id("openvdb-bricks").make({.domain = large})->build();
    CHECK_THAT(error_of([&] { save_control_space(folder / "t.vdb", *beyond); }),
               Catch::Contains("floats cannot hold"));
    CHECK_FALSE(std::filesystem::exists(folder / "t.vdb"));
}

TEST_CASE("one brick alone is saved to a .vdb, and bricks beyond the child of the root") {
    const ScratchDirectory folder;
    const auto check = [&](const ControlSpace& space) {
        save_control_space(folder / "field.vdb", space);
        const auto loaded = load_control_space(folder / "field.vdb", structures());
        const std::vector<Point> x = random_points(space.domain(), 5000, 1);
        CHECK(sample(*loaded, x) == sample(space, x));
    };
    const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .finest_length = 1};
    const auto one = structure_with_id("openvdb-bricks").make(options);
    check(*one->build({.precision = Precision::floats}));
    CHECK(grids_of(folder / "field.vdb").size() == 1);
    check(*octree_scenes::far_below_the_root().adapted("openvdb-bricks", 0.5, Precision::floats));
}

TEST_CASE("a damaged .vdb of bricks is refused in one line") {
    const Scene scene = octree_scenes::scene(0);
    const auto bricks = scene.adapted("openvdb-bricks", 1, Precision::floats);
    octree_files::check_damaged_copies(*bricks);
}

TEST_CASE("a .vdb of bricks that lies about its grids is refused, though its seal is intact") {
    const Scene scene = octree_scenes::scene(0);
    const ScratchDirectory folder;
    const auto path = folder / "field.vdb";
    save_control_space(path, *scene.adapted("openvdb-bricks", 1, Precision::floats));
    openvdb::io::File file(path.string());
    file.open(false);
    openvdb::MetaMap notes = *file.getMetadata();
    notes.insertMeta(std::string(seal_name), openvdb::StringMetadata(std::string(unsealed)));
    const auto error_with = [&](const openvdb::GridCPtrVec& grids) {
        std::ostringstream stream;
        openvdb::io::Stream(stream).write(grids, notes);
        std::string bytes = std::move(stream).str();
        seal_vdb(bytes);
        return octree_files::error_of_file(folder / "other.vdb", bytes);
    };
    const auto grids = grids_of(path);
    CHECK(error_with({grids.begin(), grids.end()}).empty());
    CHECK_THAT(error_with({grids.begin() + 1, grids.end()}),
               Catch::Contains("its grid " + grids[0]->getName() + " is missing"));
    for (const float bad : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
        const auto altered = grids[0]->deepCopy();
        altered->tree().setValueOn(altered->tree().cbeginValueOn().getCoord(), bad);
        openvdb::GridCPtrVec all(grids.begin(), grids.end());
        all[0] = altered;
        CHECK_THAT(error_with(all), Catch::Contains("bricks.pool"));
    }
}

}  // namespace controlspace::openvdb_bricks_file_test
