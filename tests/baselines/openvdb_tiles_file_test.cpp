// SPDX-License-Identifier: Apache-2.0
// The .vdb of openvdb-tiles: what this program and others find in it.
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "baselines/fixtures.h"
#include "baselines/octree_files.h"
#include "baselines/octree_scenes.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/control_space_file.h"
#include "scratch_directory.h"

namespace controlspace::openvdb_tiles_file_test {

using octree_scenes::Scene;

TEST_CASE("a .vdb of tiles answers their floats to the bit") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2, 3));
    const Box& domain = scene.domain;
    CAPTURE(domain);
    std::vector<Point> x = random_points(domain, 20000, 1);
    for (const PointSource& source : scene.sources) x.push_back(source.position);
    const ScratchDirectory folder;
    for (const auto& precision : std::initializer_list<std::optional<Precision>>{
             {}, Precision::doubles, Precision::floats, Precision::log16, Precision::log8}) {
        const auto tiles = scene.adapted("openvdb-tiles", 0.2, precision);
        save_control_space(folder / "field.vdb", *tiles);
        CHECK(holds_control_space(folder / "field.vdb"));
        const SavedControlSpace saved = open_control_space(folder / "field.vdb", structures());
        CHECK(saved.recipe.structure == "openvdb-tiles");
        CHECK(saved.recipe.precision == Precision::floats);
        CHECK(saved.space->domain() == domain);
        for (const Point& p : x) {
            REQUIRE(saved.space->length_at(p) == static_cast<float>(tiles->length_at(p)));
            REQUIRE(saved.space->cell_at(p) == tiles->cell_at(p));
        }
        const auto own = control_nodes(*tiles, Neighbourhood::faces);
        const auto theirs = control_nodes(*saved.space, Neighbourhood::faces);
        CHECK(own->metrics.size() == theirs->metrics.size());
        save_control_space(folder / "again.ctrl", *saved.space);
        const auto again = load_control_space(folder / "again.ctrl", structures());
        CHECK(sample(*again, x) == sample(*saved.space, x));
    }
}

TEST_CASE("other programs find lengths and places in a .vdb of tiles") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 3));
    const Box& domain = scene.domain;
    CAPTURE(domain);
    const auto tiles = scene.adapted("openvdb-tiles", 0.2, Precision::floats);
    const ScratchDirectory folder;
    save_control_space(folder / "field.vdb", *tiles);
    openvdb::io::File file((folder / "field.vdb").string());
    file.open(false);
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("length"));
    REQUIRE(grid);
    const auto low = grid->metaValue<openvdb::Vec3d>("domain_low");
    CHECK(Point(low.x(), low.y(), low.z()) == domain.low);
    // The tiny domain's voxels are below what OpenVDB's transforms may be.
    const auto scale_note = grid->getMetadata<openvdb::DoubleMetadata>("scale");
    CHECK((scale_note != nullptr) == (domain.edges().maxCoeff() < 1e-3));
    const double scale = scale_note ? scale_note->value() : 1;
    for (const Point& p : random_points(domain, 20000, 1)) {
        const openvdb::Vec3d at = grid->worldToIndex({scale * p.x(), scale * p.y(), scale * p.z()});
        const openvdb::Coord voxel = openvdb::Coord::round(at);
        REQUIRE(grid->tree().isValueOn(voxel));
        REQUIRE(grid->tree().getValue(voxel) == scale * tiles->length_at(p));
    }
    // It is sparse, leaves as large as a node are tiles; and nothing lies outside of the domain.
    if (grid->activeVoxelCount() > 100000) CHECK(grid->tree().activeTileCount() > 100);
    const openvdb::CoordBBox all = grid->evalActiveVoxelBoundingBox();
    const openvdb::Vec3d first = grid->indexToWorld(all.min().asVec3d() - openvdb::Vec3d(0.5)),
                         last = grid->indexToWorld(all.max().asVec3d() + openvdb::Vec3d(0.5));
    for (Axis a = 0; a < 3; ++a) {
        CHECK(first[a] / scale == Approx(domain.low[a]).margin(1e-12));
        CHECK(last[a] / scale == Approx(domain.high[a]).margin(1e-12));
    }

    // Written by such a program, it is a picture.
    octree_files::check_is_picture({grid});
}

TEST_CASE("what is no lengths of tiles is not saved to a .vdb") {
    const ScratchDirectory folder;
    const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .finest_length = 1};
    const auto builder = structure_with_id("openvdb-tiles").make(options);
    builder->insert(sample_sphere({.h = 0.2, .s_a = 2, .s_n = 0.5}));
    CHECK_THAT(error_of([&] { save_control_space(folder / "t.vdb", *builder->build()); }),
               Catch::Contains("tensors"));
    CHECK_THAT(error_of([&] { save_control_space(folder / "t.vdb", *builder); }),
               Catch::Contains(".ctrl"));
    const auto octree = structure_with_id("K_oL").make(options)->build();
    CHECK_THAT(error_of([&] { save_control_space(folder / "t.vdb", *octree); }),
               Catch::Contains("openvdb-tiles"));
    const Box large{Point(0, 0, 0), Point(1e42, 1e42, 1e42)};
    const auto beyond = structure_with_id("openvdb-tiles").make({.domain = large})->build();
    CHECK_THAT(error_of([&] { save_control_space(folder / "t.vdb", *beyond); }),
               Catch::Contains("floats cannot hold"));
    CHECK_FALSE(std::filesystem::exists(folder / "t.vdb"));
}

TEST_CASE("a damaged .vdb of tiles is refused in one line") {
    const Scene scene = octree_scenes::scene(0);
    const auto tiles = scene.adapted("openvdb-tiles", 1, Precision::floats);
    octree_files::check_damaged_copies(*tiles);
    // Cut off before it is known to be OpenVDB's, it is no control space at all.
    const ScratchDirectory folder;
    save_control_space(folder / "field.vdb", *tiles);
    std::filesystem::resize_file(folder / "field.vdb", 6);
    CHECK_FALSE(holds_control_space(folder / "field.vdb"));
    CHECK_FALSE(holds_control_space(folder / "none.vdb"));
}

}  // namespace controlspace::openvdb_tiles_file_test
