// SPDX-License-Identifier: Apache-2.0
#include "study/forecast.h"

#include <catch2/catch.hpp>
#include <functional>

#include "controlspace/baselines/catalogue.h"

namespace controlspace::forecast_test {

using Catch::Matchers::Contains;

namespace {

/// 9114 sources: more than a trial takes.
Study small_sphere() {
    Study study;
    study.sources.h = 0.03;
    study.access_points = 100;
    study.access_repeats = study.creation_repeats = 1;
    study.probe_grid = study.fine_probe_grid = 3;
    study.runs[0]["splits"] = {"s_L"};
    return study;
}

/// That bytes are foretold up to the factor `allowed(structure)`.
void check_foretold(const Study& study,
                    const std::function<double(const CatalogueEntry&)>& allowed) {
    PreparedStudy prepared(study, {structures()});
    const auto forecasts = forecast(prepared);
    const std::vector<Row> rows = std::move(prepared).run();
    REQUIRE(rows.size() == forecasts.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        INFO(structure_label(rows[i].setting));
        REQUIRE(rows[i].is_measured());
        REQUIRE(forecasts[i]);
        const double bytes = rows[i].number("bytes_total");
        const double factor = allowed(entry_of(rows[i].setting, structures()));
        CHECK(forecasts[i]->bytes > bytes / factor);
        CHECK(forecasts[i]->bytes < bytes * factor);
        CHECK(forecasts[i]->seconds > 0);
    }
}

}  // namespace

TEST_CASE("memory is foretold, of grids by their voxels, of others by patches of sources") {
    const Study study = small_sphere();
    REQUIRE(forecast(PreparedStudy(study, {structures()})).size() == structures().size());
    // Grids take as many bytes for each voxel at any size, but for the voxels at the border. The
    // leaves around the rim of a patch are too many, and the grid over a tree that starts descents
    // grows in steps: K_oL 1.56, K_oLB 1.52, K_oLA 1.30, others less.
    check_foretold(study,
                   [](const CatalogueEntry& entry) { return entry.has<VoxelSize>() ? 1.02 : 1.6; });
}

TEST_CASE("shorter leaves take more memory, and what cannot be predicted has no forecast") {
    Study study = small_sphere();
    study.runs[0]["structures"] = {"K_oL"};
    study.runs[0]["tau"] = {1, 0.25};
    const PreparedStudy prepared(study, {structures()});
    const auto forecasts = forecast(prepared);
    REQUIRE((forecasts.size() == 2 && forecasts[0] && forecasts[1]));
    CHECK(2.5 * forecasts[0]->bytes < forecasts[1]->bytes);
    CHECK_THAT(forecast_text(prepared, forecasts), Contains("2 cases: about "));
    // Voxels that are searched for by all probes.
    study.runs[0]["structures"] = {"uniform-nearest"};
    study.runs[0]["tau"] = {1};
    study.runs[0]["equal_delta"] = {0, 0.5};
    const PreparedStudy searched(study, {structures()});
    CHECK_THAT(forecast_text(searched, forecast(searched)),
               Contains("2 cases: about ") && Contains("1 of them (–) not counted"));
    study.runs[0]["equal_delta"] = {0.5};
    const PreparedStudy one(study, {structures()});
    CHECK_THAT(forecast_text(one, forecast(one)), Contains("\n1 case: no trial predicts"));
}

TEST_CASE("adapted structures are foretold by patches of sources, too") {
    Study study = small_sphere();
    study.runs[0]["structures"] = {"K_L", "K_V", "K_oL", "K_oV", "K_oLA", "uniform-nearest"};
    study.runs[0]["target_delta"] = {0.1};
    // Of a patch the rim, far from the rest of the sources, has leaves as well.
    check_foretold(study, [](const CatalogueEntry&) { return 3; });
}

TEST_CASE("a grid that outgrows the cap on memory is foretold at the cap") {
    Study study = small_sphere();
    study.runs[0]["structures"] = {"uniform-nearest"};
    study.runs[0]["voxel"] = {0.001};
    study.max_memory_gib = 0.01;
    const PreparedStudy prepared(study, {structures()});
    const auto forecasts = forecast(prepared);
    REQUIRE(forecasts[0]);
    CHECK(forecasts[0]->bytes == Approx(0.01 * 1024 * 1024 * 1024));
}

}  // namespace controlspace::forecast_test
