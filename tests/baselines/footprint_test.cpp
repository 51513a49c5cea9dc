// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "baselines/fixtures.h"
#include "counting_allocator.h"
#include "editable_space.h"

namespace controlspace::footprint_test {
namespace {

const CatalogueEntry& any_grid() {
    return grids()[static_cast<std::size_t>(GENERATE(range(0, static_cast<int>(grids().size()))))];
}

}  // namespace

TEST_CASE("a grid's footprint is what it has allocated") {
    const CatalogueEntry& entry = any_grid();
    INFO(entry.id);
    const SpaceOptions options = small_grid();
    const std::vector<PointSource> sources = random_sources(100, options);
    const std::size_t before = live_bytes();
    std::unique_ptr<ControlSpace> space;
    {
        const auto builder = entry.make(options);
        builder->insert(sources);
        space = builder->build();
    }
    const std::size_t allocated = live_bytes() - before;
    const Footprint footprint = space->footprint();
    CHECK(footprint.bytes_payload >= footprint.control_nodes * sizeof(Metric));
    // Builder and recipe are allocated but not counted. OpenVDB's own count leaves out some bytes
    // of each inner node and the root's table.
    CAPTURE(allocated, footprint.bytes_total());
    CHECK(footprint.bytes_total() <= allocated);
    CHECK(footprint.bytes_total() + 2048 >= allocated);
}

TEST_CASE("a grid and its gradation stay below the memory cap") {
    const CatalogueEntry& entry = any_grid();
    INFO(entry.id);
    SpaceOptions options = small_grid();
    options.finest_length = 1e-3;
    options.max_bytes = 4'000'000;
    const std::size_t before = live_bytes();
    reset_peak_bytes();
    const auto space = editable(entry.make(options));
    space->insert(PointSource{options.domain.centre(), Metric::isotropic(0.1)});
    space->grade(GradationOptions{});
    const Footprint footprint = space->footprint();
    CAPTURE(peak_bytes() - before, footprint.remark);
    CHECK(peak_bytes() - before <= options.max_bytes + 2048);  // the builder itself
    CHECK(footprint.bytes_total() + footprint.control_nodes * 53 <= options.max_bytes);
    // No more is given up than has to be: OpenVDB grows by whole leaves.
    CHECK(peak_bytes() - before >= options.max_bytes / 2);
    CHECK_THAT(footprint.remark, Catch::Contains("; 4000 x 2560 x 1780 would need"));
}

}  // namespace controlspace::footprint_test
