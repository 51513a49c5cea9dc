// Elements found by asking, against what structures say of themselves.
#include <catch2/catch.hpp>

#include "contract/structures_under_test.h"
#include "io/text/cells.h"

using namespace controlspace;

namespace {

double volume_of(const Box& box) { return box.edges().prod(); }

}  // namespace

TEST_CASE("the elements of every structure fill its domain, each once") {
    const Structure structure = GENERATE(from_range(all_structures()));
    CAPTURE(structure.name());
    Work work{"sphere", sample_sphere({.h = 0.15})};
    work.domain.high.z() = 2;
    const auto space = work.inserted(structure);
    const std::vector<Box> elements = elements_of(*space);
    const std::size_t leaves = space->footprint().leaves;
    if (leaves > 0) CHECK(elements.size() == leaves);
    double volume = 0;
    for (const Box& element : elements) {
        volume += volume_of(element);
        REQUIRE(space->cell_at(element.centre()).value() == element);
    }
    // Cells of a grid may reach beyond the domain.
    CHECK(volume >= Approx(volume_of(work.domain)));
    if (leaves > 0) CHECK(volume == Approx(volume_of(work.domain)));
}
