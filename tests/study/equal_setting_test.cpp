// SPDX-License-Identifier: Apache-2.0
#include "study/equal_setting.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "controlspace/error.h"

namespace controlspace::equal_setting_test {
namespace {

const CatalogueEntry grid{.id = "grid", .description = "", .capabilities = {VoxelSize()}};
const CatalogueEntry sparse{
    .id = "sparse", .description = "", .capabilities = {VoxelSize(), Pruning()}};

Case for_delta(double delta) {
    Case c;
    c.equal_delta = delta;
    return c;
}
Case for_memory(double mb) {
    Case c;
    c.equal_memory = mb;
    return c;
}

// Errors in proportion to the voxels, memory to their number.
Trial ideal(const Case& c) { return {*c.voxel, 48 * std::pow(2 / *c.voxel, 3)}; }

}  // namespace

TEST_CASE("voxels are found that just come to a delta, and no finer ones") {
    const double goal = GENERATE(0.3, 0.1, 0.0123);
    const EqualSetting found = find_equal_setting(for_delta(goal), grid, 2, ideal);
    CHECK(found.trial.delta <= goal);
    CHECK(found.trial.delta > goal / 1.03);
    CHECK(found.setting.voxel == found.trial.delta);
    CHECK(found.shortfall.empty());
}

TEST_CASE("voxels are found that just keep to a memory") {
    const double goal = GENERATE(0.5, 20.0);
    const EqualSetting found = find_equal_setting(for_memory(goal), grid, 2, ideal);
    CHECK(found.trial.bytes <= goal * 1e6);
    CHECK(found.trial.bytes > goal * 1e6 / 1.09);
    CHECK(found.shortfall.empty());
}

TEST_CASE("an error that does not go away ends the search, and is said") {
    int attempts = 0;
    const auto bounded = [&](const Case& c) {
        ++attempts;
        return Trial{0.37 + 0.001 * *c.voxel, ideal(c).bytes};
    };
    const EqualSetting found = find_equal_setting(for_delta(0.1), grid, 2, bounded);
    CHECK(attempts == 3);
    CHECK_THAT(found.shortfall, Catch::Contains("0.1 is out of reach: the smallest is 0.370"));
    CHECK(found.setting.voxel == 0.125);

    const EqualSetting small = find_equal_setting(for_memory(1e-4), grid, 2, ideal);
    CHECK_THAT(small.shortfall, Catch::Contains("no such grid fits into"));
}

TEST_CASE("a grid that takes too much memory ends the search, and a first one ends the case") {
    const auto capped = [&](const Case& c) {
        if (*c.voxel < 0.1) throw InputError("too much");
        return ideal(c);
    };
    // Not the last halved voxels, but the finest that there are.
    const EqualSetting found = find_equal_setting(for_delta(0.05), grid, 2, capped);
    CHECK(found.trial.delta >= 0.1);
    CHECK(found.trial.delta < 0.103);
    CHECK_THAT(found.shortfall, Catch::Contains("too much"));
    CHECK(find_equal_setting(for_delta(0.11), grid, 2, capped).trial.delta <= 0.11);
    CHECK_THROWS_AS(find_equal_setting(for_delta(0.05), grid, 0.1, capped), InputError);
}

TEST_CASE("voxels are pruned where that saves memory") {
    const double tile_bytes = GENERATE(0.1, 2.0);
    const auto attempt = [&](const Case& c) {
        return Trial{0.8 * *c.voxel + c.prune_delta.value_or(0),
                     (c.prune_delta ? tile_bytes : 1) * 1e6 / *c.voxel};
    };
    const EqualSetting found = find_equal_setting(for_delta(0.1), sparse, 2, attempt);
    CHECK(found.trial.delta <= 0.1);
    CHECK(found.setting.prune_delta.has_value() == (tile_bytes < 1));
    Case told = for_delta(0.1);
    told.prune_delta = 0.02;
    CHECK(find_equal_setting(told, sparse, 2, attempt).setting.prune_delta == 0.02);
}

}  // namespace controlspace::equal_setting_test
