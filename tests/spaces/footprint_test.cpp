// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>

#include "case_of_each.h"
#include "controlspace/error.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "counting_allocator.h"
#include "editable_space.h"

namespace controlspace::footprint_test {

CASE_OF_EACH(entry, all_trees(), "the footprint of a tree is what it has allocated") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.05, .rho = 2});
    const auto filled = [&](const CatalogueEntry& row) {
        auto space = editable(row.make({.domain = {Point::Constant(-1), Point::Constant(1)}}));
        space->insert(sources);
        space->grade({});
        return space;
    };
    // What threads keep from their first work on.
    constexpr std::size_t of_threads = 1024;
    filled(tree_named("K_L"));
    const std::size_t before = live_bytes();
    auto space = filled(entry);
    const std::size_t allocated = live_bytes() - before;
    std::size_t not_counted = 2048;                                    // of objects, and
    if (entry.has<MetricNodes>()) not_counted += 32 * sources.size();  // what the builder keeps
    const Footprint footprint = space->footprint();
    CHECK(footprint.bytes_total() <= allocated);
    CHECK(footprint.bytes_total() + not_counted >= allocated);
    if (entry.has<MetricNodes>()) {
        CHECK(footprint.bytes_payload == footprint.control_nodes * sizeof(Metric));
    }
    space.reset();
    CHECK(live_bytes() <= before + of_threads);
}

TEST_CASE("graded vertices keep nothing of what leaves requested") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.05, .rho = 2});
    const char* id = GENERATE("K_V", "K_oV");
    const auto bytes_if = [&](bool in_turn) {
        auto space = editable(tree_named(id).make(
            {.domain = {Point::Constant(-1), Point::Constant(1)}, .vertices_in_turn = in_turn}));
        space->insert(sources);
        space->grade({});
        const Footprint footprint = space->footprint();
        return static_cast<double>(footprint.bytes_total()) / static_cast<double>(footprint.cells);
    };
    CHECK(bytes_if(false) <= 1.02 * bytes_if(true));
}

CASE_OF_EACH(entry, tree_catalogue(),
             "creation takes less than 2.7 times the memory that a tree ends up with") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.02});
    const std::size_t before = live_bytes();
    reset_peak_bytes();
    auto space = editable(entry.make({.domain = {Point::Constant(-1), Point::Constant(1)}}));
    space->insert(sources);
    const std::size_t inserting = peak_bytes() - before;
    reset_peak_bytes();
    space->grade({});
    const std::size_t grading = peak_bytes() - before;
    const auto last = static_cast<double>(live_bytes() - before);
    CAPTURE(static_cast<double>(inserting) / last, static_cast<double>(grading) / last);
    CHECK(static_cast<double>(std::max(inserting, grading)) < 2.7 * last);
}

CASE_OF_EACH(entry, tree_catalogue(),
             "a tree that outgrows the memory cap stops below it, with what would help") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.01, .rho = 2});
    constexpr std::size_t cap = 8'000'000;
    const auto space = editable(entry.make(
        {.domain = {Point::Constant(-1), Point::Constant(1)}, .l_min = 0.1, .max_bytes = cap}));
    const std::size_t before = live_bytes();
    reset_peak_bytes();
    CHECK_THROWS_WITH(space->insert(sources), Catch::Matchers::Contains("more than 0.00745 GiB") &&
                                                  Catch::Matchers::Contains("raise tau"));
    // While an array grows, the old one and a new one twice as long are there.
    CHECK(peak_bytes() - before < cap);
    CHECK(peak_bytes() - before > cap / 8);
}

CASE_OF_EACH(entry, tree_catalogue(),
             "a cap that holds no tree is refused on a coarse sphere too") {
    const auto space = editable(entry.make(
        {.domain = {Point::Constant(-1), Point::Constant(1)}, .l_min = 0.1, .max_bytes = 1000}));
    CHECK_THROWS_WITH(space->insert(sample_sphere({.h = 0.2})),
                      Catch::Matchers::Contains("more than 9.31e-07 GiB"));
}

CASE_OF_EACH(entry, tree_catalogue(), "the memory cap holds for gradation too") {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.02, .rho = 2});
    const auto neighbourhood = GENERATE(Neighbourhood::faces, Neighbourhood::all);
    // The smallest cap, in steps of 10 %, that takes the sources and their gradation.
    std::unique_ptr<EditableSpace> space;
    std::size_t cap = 1'000'000;
    std::size_t before = 0;
    while (!space) {
        cap += cap / 10;
        before = live_bytes();
        space = editable(
            entry.make({.domain = {Point::Constant(-1), Point::Constant(1)}, .max_bytes = cap}));
        try {
            space->insert(sources);
            reset_peak_bytes();
            space->grade({.neighbourhood = neighbourhood});
        } catch (const InputError&) {
            space.reset();
        }
    }
    CAPTURE(cap, space->footprint().cells, peak_bytes() - before);
    CHECK(peak_bytes() - before < cap);
    CHECK(peak_bytes() - before > cap / 4);
}

}  // namespace controlspace::footprint_test
