// SPDX-License-Identifier: Apache-2.0
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>

#include "controlspace/io/read_vdb.h"
#include "export/fixtures.h"

namespace controlspace::read_vdb_sources_test {

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

constexpr double voxel = 0.05;
const Point centre(1, 2, 3);

openvdb::FloatGrid::Ptr sphere(double radius) {
    openvdb::initialize();
    const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
        static_cast<float>(radius), {1, 2, 3}, static_cast<float>(voxel));
    grid->setName("ball");
    return grid;
}

/// The surface of the unit cube.
openvdb::FloatGrid::Ptr cube() {
    const std::vector<openvdb::Vec3s> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                             {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const std::vector<openvdb::Vec4I> quads{{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                            {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, quads);
    grid->setName("cube");
    return grid;
}

}  // namespace

TEST_CASE("a level set gives points on its surface, one in each voxel that it crosses") {
    const ScratchDirectory folder;
    const double radius = 0.8;
    const auto sources = read_vdb_sources(write_grids(folder, {sphere(radius)}), {.h = 0.1});
    double farthest = 0;
    Point sum = Point::Zero();
    for (const PointSource& s : sources) {
        farthest = std::max(farthest, std::abs((s.position - centre).norm() - radius));
        sum += s.position;
        CHECK(s.metric == Metric::isotropic(0.1));
    }
    CHECK(farthest < 0.02 * voxel);
    CHECK((sum / static_cast<double>(sources.size()) - centre).norm() < 0.01);
    // A plane meets |n_x| + |n_y| + |n_z| voxels for each of its own area, 1.5 on average over a
    // sphere. Counted by the signs at their corners there are 1.4 % fewer, as it is curved.
    const double area = 4 * 3.14159265 * radius * radius / (voxel * voxel);
    CHECK(static_cast<double>(sources.size()) == Approx(1.5 * area).epsilon(0.02));
}

TEST_CASE("lengths by curvature are the radius's share, bounded by voxel and box") {
    const ScratchDirectory folder;
    for (const double radius : {0.4, 0.8}) {
        const auto path = write_grids(folder, {sphere(radius)});
        for (const PointSource& s : read_vdb_sources(path, {.per_radius = 0.5})) {
            REQUIRE(s.metric.xx == Approx(0.5 * radius).epsilon(0.05));
            REQUIRE(is_isotropic(s.metric));
        }
        for (const PointSource& s : read_vdb_sources(path, {.per_radius = 1e-3})) {
            REQUIRE(s.metric.xx == Approx(voxel));
        }
    }
    const auto on_cube = read_vdb_sources(write_grids(folder, {cube()}), {.per_radius = 0.5});
    double largest = 0;
    double on_edges = 1e9;
    for (const PointSource& s : on_cube) {
        const auto from_middle = (s.position.array() - 0.5).abs();
        const bool near_edge = (from_middle > 0.45).count() > 1;
        if (near_edge) on_edges = std::min(on_edges, s.metric.xx);
        largest = std::max(largest, s.metric.xx);
    }
    CHECK(on_edges == Approx(voxel));
    // Flat faces: half the diagonal of the box of the narrow band.
    CHECK(largest > 0.8);
    CHECK(largest < 1.2);
}

TEST_CASE("a fog's surface is where it is one half, unless an isovalue says otherwise") {
    const ScratchDirectory folder;
    const auto fog = sphere(0.8);
    openvdb::tools::sdfToFogVolume(*fog);
    const auto path = write_grids(folder, {fog});
    // Within the band of three voxels a fog grows linearly from the surface inwards.
    const auto mean_radius = [&](const VdbSurface& options) {
        double sum = 0;
        const auto sources = read_vdb_sources(path, options);
        for (const PointSource& s : sources) sum += (s.position - centre).norm();
        return sum / static_cast<double>(sources.size());
    };
    CHECK(mean_radius({.h = 0.1}) == Approx(0.8 - 1.5 * voxel).margin(0.05 * voxel));
    CHECK(mean_radius({.isovalue = 0.25, .h = 0.1}) ==
          Approx(0.8 - 0.75 * voxel).margin(0.05 * voxel));
}

TEST_CASE("surfaces that cannot be used are refused in one line") {
    const ScratchDirectory folder;
    const auto error = [&](const openvdb::GridCPtrVec& grids, const VdbSurface& options) {
        const fs::path path = write_grids(folder, grids);
        return error_of([&] { read_vdb_sources(path, options); });
    };
    const auto ball = sphere(0.8);
    CHECK_THAT(error({ball}, {}), Contains("length"));
    CHECK_THAT(error({ball}, {.h = 0.1, .per_radius = 0.1}), Contains("length"));
    CHECK_THAT(error({ball}, {.h = -0.1}), Contains("positive"));
    CHECK_THAT(error({ball}, {.per_radius = std::nan("")}), Contains("positive"));
    CHECK_THAT(error({ball, cube()}, {.h = 0.1}), Contains("ball (float), cube (float)"));
    CHECK_THAT(error({ball}, {.grid = "none", .h = 0.1}), Contains("no grid 'none'"));
    CHECK_THAT(error({ball}, {.isovalue = 7, .h = 0.1}), Contains("no surface at 7"));

    const auto plain = sphere(0.8);
    plain->setGridClass(openvdb::GRID_UNKNOWN);
    CHECK_THAT(error({plain}, {.h = 0.1}), Contains("isovalue"));
    CHECK(error({plain}, {.isovalue = 0.0, .h = 0.1}).empty());

    // A file of some kilobytes whose surface has 25 million voxels; of a smaller cube it is read.
    const auto fog = [&](int edge) {
        const auto grid = openvdb::FloatGrid::create(0);
        grid->setName("fog");
        grid->setGridClass(openvdb::GRID_FOG_VOLUME);
        grid->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(edge - 1)), 1);
        return grid;
    };
    CHECK_THAT(error({fog(2048)}, {.h = 0.1}), Contains("a surface of some 25 million voxels"));
    CHECK(error({fog(256)}, {.h = 0.1}).empty());

    const auto broken = sphere(0.8);
    broken->tree().setValueOn(broken->tree().cbeginLeaf()->origin(), std::nanf(""));
    CHECK_THAT(error({broken}, {.h = 0.1}), Contains("nan") && Contains("voxel"));
}

}  // namespace controlspace::read_vdb_sources_test
