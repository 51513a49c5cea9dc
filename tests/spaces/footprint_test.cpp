#include <catch2/catch.hpp>

#include "counting_allocator.h"
#include "gradation/grade.h"
#include "sources/sampled_surfaces.h"
#include "spaces/catalogue.h"

using namespace controlspace;

TEST_CASE("the footprint of a tree is what it has allocated") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.05, .rho = 2});
    for (const CatalogueEntry& entry : tree_catalogue()) {
        CAPTURE(entry.id);
        const std::size_t before = live_bytes();
        auto space = entry.make({.domain = {Point::Constant(-1), Point::Constant(1)}});
        space->insert(sources);
        space->grade({});
        const std::size_t allocated = live_bytes() - before;
        // The object itself is allocated but not counted.
        const Footprint footprint = space->footprint();
        CHECK(footprint.bytes_total() <= allocated);
        CHECK(footprint.bytes_total() + 1024 >= allocated);
        CHECK(footprint.bytes_payload == footprint.control_nodes * sizeof(Metric));
        space.reset();
        CHECK(live_bytes() == before);
    }
}
