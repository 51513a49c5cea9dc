// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "baselines/fixtures.h"
#include "baselines/octree_scenes.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "counting_allocator.h"

namespace controlspace::openvdb_tiles_test {

using octree_scenes::g, octree_scenes::Scene;

TEST_CASE("tiles answer as the octree does that they are made of") {
    const Scene scene = octree_scenes::scene(GENERATE(0, 1, 2));
    const Box& domain = scene.domain;
    CAPTURE(domain);
    std::vector<Point> x = random_points(domain, 20000, 1);
    for (const PointSource& source : scene.sources) x.push_back(source.position);
    // Faces of leaves, as the octree halves its boxes, and beside them.
    const auto halved = scene.adapted("K_oL", 0.2, {});
    for (std::size_t i = 0; i < 2000; ++i) {
        const Box leaf = halved->cell_at(x[i]).value();
        for (Axis a = 0; a < 3; ++a) {
            for (const double face : {leaf.low[a], leaf.high[a]}) {
                for (const double beside : {-1e9, face, 1e9}) {
                    Point p = x[i];
                    p[a] = std::nextafter(face, beside);
                    x.push_back(p);
                }
            }
        }
    }
    const Vector beyond = 0.3 * domain.edges() + Vector::Constant(1e-3);
    for (const Point& p : random_points({domain.low - beyond, domain.high + beyond}, 2000, 2)) {
        x.push_back(p);
    }
    for (const auto& precision : std::initializer_list<std::optional<Precision>>{
             {}, Precision::doubles, Precision::floats, Precision::log16, Precision::log8}) {
        const auto octree = scene.adapted("K_oL", 0.2, precision);
        const auto tiles = scene.adapted("openvdb-tiles", 0.2, precision);
        for (const Point& p : x) REQUIRE(sample_at(*octree, p) == sample_at(*tiles, p));
        std::vector<Metric> theirs(x.size()), own(x.size());
        octree->sample(x, theirs);
        tiles->sample(x, own);
        CHECK(own == theirs);
        CHECK(tiles->footprint().control_nodes == octree->footprint().control_nodes);
        CHECK(tiles->footprint().remark.empty());
        for (const Point& p : x) {
            const Box cell = tiles->cell_at(p).value();
            REQUIRE(cell.contains(nearest_in(domain, p)));
            REQUIRE(sample_at(*tiles, cell.centre()) == sample_at(*tiles, p));
        }
    }
}

TEST_CASE("tiles of tensors answer as the octree does") {
    const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .finest_length = 1};
    const std::vector<PointSource> sources = sample_sphere({.h = 0.2, .s_a = 2, .s_n = 0.5});
    for (const auto& precision : {Precision::doubles, Precision::floats}) {
        std::vector<std::unique_ptr<ControlSpace>> made;
        for (const char* id : {"K_oL", "openvdb-tiles"}) {
            const auto builder = structure_with_id(id).make(options);
            builder->insert(sources);
            builder->grade({});
            made.push_back(builder->build({.precision = precision}));
        }
        for (const Point& p : random_points(options.domain, 20000, 1)) {
            REQUIRE(sample_at(*made[0], p) == sample_at(*made[1], p));
        }
    }
}

TEST_CASE("tiles hold one number a voxel where all is isotropic, as they say") {
    const Scene scene = octree_scenes::scene(0);
    const auto floats = scene.adapted("openvdb-tiles", 0.2, Precision::floats);
    const auto doubles = scene.adapted("openvdb-tiles", 0.2, Precision::doubles);
    const auto codes = scene.adapted("openvdb-tiles", 0.2, Precision::log8);
    CHECK(2 * floats->footprint().bytes_payload == doubles->footprint().bytes_payload);
    CHECK(4 * codes->footprint().bytes_total() < floats->footprint().bytes_total());
    // What the allocator is asked for, but for some 16 bytes a block that OpenVDB does not count.
    const Footprint footprint = floats->footprint();
    const std::size_t before = live_bytes();
    const auto again = scene.adapted("openvdb-tiles", 0.2, Precision::floats);
    const auto counted = static_cast<double>(footprint.bytes_total());
    CHECK(static_cast<double>(live_bytes() - before) == Approx(counted).epsilon(0.03));
}

TEST_CASE("tiles beyond the child of the root are told, and those beyond memory refused") {
    const Scene scene = octree_scenes::far_below_the_root();
    const auto tiles = scene.adapted("openvdb-tiles", 0.5, Precision::floats);
    CHECK_THAT(tiles->footprint().remark, Catch::Contains("upper nodes"));
    const auto octree = scene.adapted("K_oL", 0.5, Precision::floats);
    for (const Point& p : random_points(scene.domain, 20000, 1)) {
        REQUIRE(sample_at(*octree, p) == sample_at(*tiles, p));
    }
    const std::size_t bytes = tiles->footprint().bytes_total();
    SpaceOptions options = scene.options();
    options.max_bytes = bytes - bytes / 10;
    const auto builder = structure_with_id("openvdb-tiles").make(options);
    REQUIRE(builder->adapt({scene.sources, nullptr, g, 0.5}).met);
    CHECK_THROWS_AS(builder->build({.precision = Precision::floats}), MemoryLimitError);
}

}  // namespace controlspace::openvdb_tiles_test
