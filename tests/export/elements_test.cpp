// SPDX-License-Identifier: Apache-2.0
// Elements found by asking, against what structures say of themselves.
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "io/text/cells.h"

namespace controlspace::elements_test {
namespace {

double volume_of(const Box& box) { return box.edges().prod(); }

}  // namespace

STRUCTURE_CASE(does_not_round, "the elements of a structure fill its domain, each once") {
    Work work{"sphere", sample_sphere({.h = 0.15})};
    work.domain.high.z() = 2;
    const auto space = work.inserted(structure);
    const std::vector<Box> elements = elements_of(*space);
    const bool is_tree = space->footprint().tree_nodes > 0;
    if (is_tree) CHECK(elements.size() == space->footprint().cells);
    double volume = 0;
    for (const Box& element : elements) {
        volume += volume_of(element);
        // The border of a grid's cell is rounded in two ways.
        const Box cell = space->cell_at(element.centre()).value();
        REQUIRE(cell.low.isApprox(element.low, 1e-12));
        REQUIRE(cell.high.isApprox(element.high, 1e-12));
    }
    // Cells of a grid may reach beyond the domain.
    CHECK(volume >= Approx(volume_of(work.domain)));
    if (is_tree) CHECK(volume == Approx(volume_of(work.domain)));
}

}  // namespace controlspace::elements_test
