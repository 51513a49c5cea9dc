// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>

#include "baselines/peers/nanovdb/dense_grid.h"
#include "controlspace/error.h"
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

TEST_CASE("a sparse NanoVDB grid answers K_oL's floats, to the bit, and its codes near to them") {
    const Work work = GENERATE(oblong_box(), flat_box(), isotropic_sphere());
    CAPTURE(work.name);
    const auto places = places_in(work, 20000);
    const auto octree = finished("K_oL", work), floats = finished("nanovdb-tiles", work),
               codes = finished("nanovdb-tiles-fp8", work);
    const auto cursor = floats->cursor();
    double largest = 1, range = 1;
    const auto exact = lengths_at(*octree, places), batch = lengths_at(*floats, places),
               rounded = lengths_at(*codes, places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        REQUIRE(batch[i] == static_cast<float>(exact[i]));
        REQUIRE(floats->length_at(places[i]) == batch[i]);
        REQUIRE(cursor->length_at(places[i]) == batch[i]);
        REQUIRE(codes->length_at(places[i]) == rounded[i]);
        largest = std::max({largest, rounded[i] / exact[i], exact[i] / rounded[i]});
        range = std::max(range, exact[i] / std::ranges::min(exact));
    }
    // Half a step of 255 between the least and the largest length of a leaf, at most of all.
    CHECK(largest > 1);
    CHECK(largest <= 1 + 0.5 * (range - 1) / 255 + 1e-6);
    CHECK(codes->footprint().control_nodes == octree->footprint().control_nodes);
    CHECK(4 * codes->footprint().bytes_payload == floats->footprint().bytes_payload);
}

TEST_CASE("sparse NanoVDB grids keep a target by what they answer, codes too") {
    const Work work = isotropic_sphere();
    const std::string id = GENERATE("nanovdb-tiles", "nanovdb-tiles-fp8");
    CAPTURE(id);
    const auto made = [&](const std::string& structure) {
        const auto builder = row_named(structure).make(work.options());
        AdaptationGoal goal;
        goal.sources = work.sources;
        goal.target = 0.1;
        const AdaptationReport report = builder->adapt(goal);
        if (structure != "direct") {
            CHECK(report.met);
            CHECK(report.is_bound);
            CHECK(report.reached <= 0.1);
        }
        return builder->build();
    };
    const auto space = made(id), exact = made("direct");
    const auto places = places_in(work, 100000);
    const auto own = answers_at(*space, places), field = answers_at(*exact, places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        REQUIRE(nonconformity(own[i], field[i]) <= 0.1);
    }
}

TEST_CASE("sparse NanoVDB grids refuse tensors") {
    CHECK_THROWS_AS(finished("nanovdb-tiles", anisotropic_oblong_box()), InputError);
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
