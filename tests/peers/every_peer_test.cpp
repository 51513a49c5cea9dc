// SPDX-License-Identifier: Apache-2.0
// Laws that every foreign system keeps, whatever its own law of growth.
#include <algorithm>
#include <catch2/catch.hpp>
#include <stdexcept>

#include "baselines/add_structures.h"
#include "case_of_each.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/sample_parallel.h"
#include "peers/peers.h"

namespace controlspace::every_peer_test {
namespace {

const std::vector<CatalogueEntry>& peers() {
    static const std::vector<CatalogueEntry> rows = peer_rows();
    return rows;
}

}  // namespace

CASE_OF_EACH(entry, peers(), "lengths are between the shortest requested and M_max") {
    const Work work = oblong_box();
    const auto space = finished(entry.id, work);
    const double longest = work.domain.half_diagonal();
    const double shortest = finest_length(work.sources);
    for (const double h : lengths_at(*space, places_in(work))) {
        REQUIRE(h >= shortest * (1 - 1e-6));
        REQUIRE(h <= longest * (1 + 1e-6));
    }
}

CASE_OF_EACH(entry, peers(), "one place at a time gets what many at once get") {
    const Work work = oblong_box();
    const auto space = finished(entry.id, work);
    const std::vector<Point> places = places_in(work);
    const std::vector<Metric> together = answers_at(*space, places);
    // Gmsh begins where its last search ended, and on a face either tetrahedron answers.
    const double rounding = entry.id == "gmsh-view" ? 1e-12 : 0;
    for (std::size_t i = 0; i < places.size(); i += 7) {
        REQUIRE(nonconformity(sample_at(*space, places[i]), together[i]) <= rounding);
    }
}

CASE_OF_EACH(entry, peers(), "all threads together get what one gets") {
    const Work work = oblong_box();
    const auto space = finished(entry.id, work);
    const std::vector<Point> places = places_in(work, 20000);
    std::vector<Metric> together(places.size());
    sample_parallel(*space, places, together);
    CHECK(differing(together, answers_at(*space, places)) == 0);
}

CASE_OF_EACH(entry, peers(), "a place outside gets the answer of the domain's nearest point") {
    const Work work = oblong_box();
    const auto space = finished(entry.id, work);
    const Box& box = work.domain;
    for (const Point& x : places_in(work, 200)) {
        const Point outside = box.low + 3 * (x - box.low) - 0.9 * box.edges();
        const Point inside = outside.cwiseMax(box.low).cwiseMin(box.high);
        REQUIRE(sample_at(*space, outside) == sample_at(*space, inside));
    }
}

CASE_OF_EACH(entry, peers(), "without sources every place gets M_max") {
    Work work = oblong_box();
    const std::vector<Point> places = places_in(work, 50);
    // Grids need a length for their voxels.
    SpaceOptions options = work.options();
    const auto space = entry.make(options)->build();
    for (const double h : lengths_at(*space, places)) {
        REQUIRE(h == Approx(work.domain.half_diagonal()).epsilon(1e-6));
    }
}

CASE_OF_EACH(entry, peers(), "the footprint counts what it holds") {
    const Work work = oblong_box();
    const Footprint footprint = finished(entry.id, work)->footprint();
    CHECK(footprint.control_nodes > 0);
    const std::size_t number = entry.own_precision == "8 bits" ? 1 : sizeof(float);
    CHECK(footprint.bytes_payload >= footprint.control_nodes * number);
    CHECK(footprint.bytes_topology > 0);
}

TEST_CASE("rows that come after the first use of the list are refused") {
    CHECK_FALSE(structures().empty());
    CHECK_THROWS_AS(add_structures(peers()), std::logic_error);
}

CASE_OF_EACH(entry, peers(), "a peer is of the family peers, with an id of its own") {
    CHECK(entry.family == "peers");
    CHECK(std::ranges::count(peers(), entry.id, &CatalogueEntry::id) == 1);
    CHECK(find_entry(structures(), entry.id) == nullptr);
}

}  // namespace controlspace::every_peer_test
