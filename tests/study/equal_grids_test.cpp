// SPDX-License-Identifier: Apache-2.0
// Grids of the catalogue, made equal by their voxels.
#include <catch2/catch.hpp>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/study/run.h"
#include "study/equal_setting.h"

namespace controlspace::equal_grids_test {
namespace {

std::vector<Row> rows_of(const Run& run) {
    Study study;
    study.sources.h = 0.1;
    study.access_points = 1000;
    study.access_repeats = 3;
    study.creation_repeats = 1;
    study.probe_grid = 12;
    study.fine_probe_grid = 3;
    study.runs = {run};
    return PreparedStudy(study, {structures()}).run();
}

}  // namespace

TEST_CASE("every grid comes to an accuracy, and the row says by which voxels") {
    for (const Row& row : rows_of({{"structures", {"baselines"}}, {"equal_delta", {0.05}}})) {
        if (!entry_of(row.setting, structures()).has<VoxelSize>()) continue;
        CAPTURE(structure_label(row.setting), row.error);
        REQUIRE(row.is_measured());
        CHECK(std::max(row.number("delta_R_max"), row.number("delta_R_fine_max")) <= 0.05);
        REQUIRE(row.setting.voxel);
        Run again{{"structures", {row.setting.structure}}};
        again["voxel"] = {*row.setting.voxel};
        again["prune_delta"] = {row.setting.prune_delta.value_or(0)};
        const Row other = rows_of(again).front();
        REQUIRE(other.is_measured());
        CHECK(other.number("delta_R_max") == row.number("delta_R_max"));
        CHECK(other.number("bytes_total") == row.number("bytes_total"));
    }
}

TEST_CASE("every grid keeps to a memory, and uses it", "[long]") {
    for (const Row& row : rows_of({{"structures", {"baselines"}}, {"equal_memory", {8}}})) {
        if (!entry_of(row.setting, structures()).has<VoxelSize>()) continue;
        CAPTURE(structure_label(row.setting), row.error);
        REQUIRE(row.is_measured());
        CHECK(row.number("bytes_total") <= 8'000'000);
        CHECK(row.number("bytes_total") > 4'000'000);
    }
}

}  // namespace controlspace::equal_grids_test
