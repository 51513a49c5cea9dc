// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>

#include "baselines/peers/nanovdb/dense_grid.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_nodes.h"
#include "peers/peers.h"

namespace controlspace::nanovdb_test {

TEST_CASE("NanoVDB answers as the structure that it is a copy of") {
    const Work work = GENERATE(oblong_box(), anisotropic_oblong_box(), flat_box());
    CAPTURE(work.name);
    const auto places = places_in(work);
    const auto nano = answers_at(*finished("nanovdb-trilinear", work), places);
    const auto open = answers_at(*finished("openvdb-vec3s-trilinear", work), places);
    CHECK(differing(nano, open) == 0);

    const auto nearest = answers_at(*finished("nanovdb-nearest", work), places);
    const auto uniform = answers_at(*finished("uniform-nearest", work), places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        REQUIRE(nonconformity(nearest[i], uniform[i]) < 1e-6);
    }
}

TEST_CASE("NanoVDB counts its blocks of memory: of lengths one number a node, else six") {
    const auto [work, numbers] =
        GENERATE(std::pair(oblong_box(), 1), std::pair(anisotropic_oblong_box(), 6));
    const Footprint nano = finished("nanovdb-trilinear", work)->footprint();
    const Footprint open = finished("openvdb-vec3s-trilinear", work)->footprint();
    CHECK(nano.control_nodes == open.control_nodes);
    CHECK(6 * nano.bytes_payload == static_cast<std::size_t>(numbers) * open.bytes_payload);
}

// The kernel's function, called here.
TEST_CASE("NanoVDB answers on a GPU as here, to the bit") {
    const Work work = GENERATE(oblong_box(), anisotropic_oblong_box(), flat_box());
    CAPTURE(work.name);
    const auto space = finished("nanovdb-trilinear", work);
    const ControlNodes nodes = control_nodes(*space, Neighbourhood::faces).value();
    const Lattice& lattice = std::get<Lattice>(nodes.graph);
    const DenseNanoGrids grids(lattice, nodes.metrics);
    NanoView view = nano_view(work.domain, lattice);
    view.diagonals = grids.diagonals.grid<nanovdb::Vec3f>();
    view.off_diagonals = grids.off_diagonals.grid<nanovdb::Vec3f>();

    auto places = places_in(work);
    for (std::size_t i = 0, n = places.size(); i < n; ++i) {
        places.push_back(work.domain.low + 1.5 * (places[i] - work.domain.low));  // outside, too
    }
    places.push_back(work.domain.high);
    std::vector<Metric> answers;
    for (const Point& x : places) {
        double m[6];
        answer_metric(view, x.data(), m);
        answers.push_back({m[0], m[1], m[2], m[3], m[4], m[5]});
    }
    CHECK(differing(answers, answers_at(*space, places)) == 0);
    if (!std::ranges::all_of(nodes.metrics, is_isotropic)) return;

    const NanoHandle lengths = dense_lengths(lattice, nodes.metrics);
    view.lengths = lengths.grid<float>();
    for (std::size_t i = 0; i < places.size(); ++i) {
        double length;
        answer_length(view, places[i].data(), &length);
        CHECK(length == answers[i].xx);
    }
}

}  // namespace controlspace::nanovdb_test
