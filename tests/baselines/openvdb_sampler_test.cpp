// SPDX-License-Identifier: Apache-2.0
#include <openvdb/tools/Interpolation.h>

#include <catch2/catch.hpp>

#include "baselines/fixtures.h"
#include "baselines/openvdb/openvdb_value.h"

namespace controlspace::openvdb_sampler_test {

TEST_CASE("the trilinear grids answer as OpenVDB's own BoxSampler does") {
    const SpaceOptions options = small_grid();
    const auto grid = make_structure("openvdb-uniform-trilinear", options);
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

}  // namespace controlspace::openvdb_sampler_test
