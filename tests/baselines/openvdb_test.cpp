#include <openvdb/tools/Interpolation.h>

#include <catch2/catch.hpp>

#include "baselines/fixtures.h"
#include "baselines/openvdb_grid.h"
#include "baselines/openvdb_value.h"
#include "baselines/uniform_grid.h"

namespace controlspace {

TEST_CASE("OpenVDB and the uniform grid agree to the bit") {
    const auto interpolation = GENERATE(Interpolation::nearest, Interpolation::trilinear);
    const SpaceOptions options = small_grid();
    const auto uniform = make_uniform_grid(options, interpolation);
    const auto vdb = make_openvdb_grid(options, interpolation);
    const std::vector<PointSource> sources = random_sources(3000, options);
    CHECK(uniform->insert(sources).inserted == vdb->insert(sources).inserted);

    std::mt19937_64 random(11);
    std::vector<Point> points;
    for (int i = 0; i < 20000; ++i) points.push_back(random_point(random, options.domain));
    CHECK(sample(*uniform, points) == sample(*vdb, points));

    GradationOptions gradation;
    gradation.law = GradationLaw::mean_length;
    CHECK(uniform->grade(gradation).operations == vdb->grade(gradation).operations);
    CHECK(sample(*uniform, points) == sample(*vdb, points));
}

TEST_CASE("the trilinear grids answer as OpenVDB's own BoxSampler does") {
    const SpaceOptions options = small_grid();
    const auto grid = make_openvdb_grid(options, Interpolation::trilinear);
    grid->insert(random_sources(3000, options));
    const ControlNodes nodes = grid->control_nodes(Neighbourhood::faces);
    const auto& lattice = std::get<Lattice>(nodes.graph);
    VdbMetricTree tree;
    for (NodeIndex n = 0; n < lattice.size(); ++n) {
        const auto [i, j, k] = lattice.coordinates(n);
        tree.setValue(openvdb::Coord(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)),
                      VdbMetric(nodes.metrics[n]));
    }

    std::mt19937_64 random(13);
    for (int i = 0; i < 5000; ++i) {
        const Point x = random_point(random, options.domain);
        const Vector place = (x - lattice.origin).cwiseQuotient(lattice.spacing);
        const VdbMetric expected = openvdb::tools::BoxSampler::sample(
            tree, openvdb::Vec3R(place.x(), place.y(), place.z()));
        REQUIRE(difference(sample_at(*grid, x), expected.metric) <= 1e-13);
    }
}

TEST_CASE("the arithmetic of OpenVDB's values is entry by entry") {
    const VdbMetric a(Metric{1, 2, 3, 4, 5, 6});
    CHECK(VdbMetric(0) + a == a);
    CHECK((a - a) == VdbMetric(0));
    CHECK(-a == VdbMetric(Metric{-1, -2, -3, -4, -5, -6}));
    CHECK(Abs(-a) == a);
    CHECK(a * 2 == a + a);
    CHECK(VdbMetric(Metric{1, 2, 3, 4, 5, 5}) < a);
    CHECK(a > VdbMetric(1));
}

}  // namespace controlspace
