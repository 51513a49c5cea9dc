#include "study/run.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "controlspace/error.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

/// A small sphere in few probes: a second for all trees.
Study small_study(std::vector<std::string> structures) {
    Study study;
    study.sources.h = 0.2;
    study.access_points = 1000;
    study.access_repeats = 3;
    study.probe_grid = 8;
    study.fine_probe_grid = 9;
    study.runs[0].structures = std::move(structures);
    study.runs[0].splits = {SplitRule::middle};
    return study;
}

std::vector<Row> run(const Study& study, std::span<const CatalogueEntry> catalogue) {
    std::vector<Row> rows;
    PreparedStudy(study, catalogue)
        .run({.case_started = {}, .phase_started = {}, .case_finished = [&](const Row& row) {
                  rows.push_back(row);
              }});
    return rows;
}

/// The first tree under another name, and one that cannot be made.
std::vector<CatalogueEntry> catalogue_with_failures() {
    const auto trees = tree_catalogue();
    std::vector<CatalogueEntry> entries(trees.begin(), trees.end());
    CatalogueEntry broken = entries.front();
    broken.id = "broken";
    broken.capabilities.clear();
    broken.construct = [](const SpaceOptions&) -> std::unique_ptr<ControlSpaceBuilder> {
        throw InputError("cannot be made");
    };
    entries.insert(entries.begin(), broken);
    CatalogueEntry greedy = broken;
    greedy.id = "greedy";
    greedy.construct = [](const SpaceOptions&) -> std::unique_ptr<ControlSpaceBuilder> {
        throw std::bad_alloc();
    };
    entries.push_back(greedy);
    return entries;
}

}  // namespace

TEST_CASE("a study gives a row with measures for every case") {
    const auto rows = run(small_study({"trees"}), tree_catalogue());
    REQUIRE(rows.size() == 6);
    for (const Row& row : rows) {
        INFO(structure_label(row.setting));
        REQUIRE(row.measures);
        CHECK(row.error.empty());
        const Measures& m = *row.measures;
        CHECK(row.sources > 100);
        CHECK(m.sources_inserted > 0);
        CHECK(m.sources_inserted <= row.sources);
        CHECK(m.footprint.leaves > 1);
        CHECK(m.access_random.samples_ns.size() == 3);
        CHECK(m.access_random.checksum != m.access_grid.checksum);
        CHECK(m.accuracy.max > 0);
        CHECK(m.accuracy.mean < m.accuracy.max);
        CHECK(m.gradation.largest_ratio_left < 1.2501);
    }
}

TEST_CASE("the same study gives the same answers") {
    const Study study = small_study({"K_L", "K_oV"});
    const auto first = run(study, tree_catalogue());
    const auto second = run(study, tree_catalogue());
    REQUIRE(first.size() == second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        CHECK(first[i].measures->access_random.checksum ==
              second[i].measures->access_random.checksum);
        CHECK(first[i].measures->accuracy_fine.mean == second[i].measures->accuracy_fine.mean);
    }
}

TEST_CASE("structures that cannot run are rows with their reason, and others still run") {
    const auto rows = run(small_study({"all"}), catalogue_with_failures());
    REQUIRE(rows.size() == 8);
    CHECK(rows[0].error == "cannot be made");
    CHECK_FALSE(rows[0].measures);
    CHECK(rows[1].measures);
    CHECK_THAT(rows[7].error, Contains("out of memory"));
}

TEST_CASE("reference and sources are made once for the cases that share them") {
    Study study = small_study({"K_L", "K_oL"});
    study.runs[0].rho = {1, 0.7};
    study.runs[0].reference = {ReferenceKind::exact, ReferenceKind::published_sphere};
    study.runs.push_back(study.runs[0]);
    study.runs[1].tau = {2};
    PreparedStudy prepared(study, tree_catalogue());
    CHECK(prepared.cases().size() == 16);
    CHECK(std::set<std::size_t>(prepared.source_counts().begin(), prepared.source_counts().end())
              .size() == 2);
    std::map<std::string_view, int> phases;
    std::size_t failed = 0;
    std::move(prepared).run(
        {.case_started = {},
         .phase_started = [&](std::string_view phase) { ++phases[phase]; },
         .case_finished = [&](const Row& row) { failed += row.measures ? 0 : 1; }});
    CHECK(failed == 0);
    CHECK(phases["reference field"] == 4);
    CHECK(phases["insertion"] == 16);
}

TEST_CASE("with a target, trees are adapted, once for all rules, and say what they reached") {
    Study study = small_study({"K_V", "K_oL"});
    study.runs[0].splits = {SplitRule::middle, SplitRule::golden};
    study.runs[0].target_delta = {0, 0.3};
    const auto rows = run(study, tree_catalogue());
    REQUIRE(rows.size() == 5);
    for (const Row& row : rows) {
        REQUIRE(row.measures);
        if (!row.setting.target_delta) {
            CHECK(row.measures->footprint.remark.empty());
            continue;
        }
        CHECK(row.measures->footprint.remark.find("reached") != std::string::npos);
        CHECK(row.measures->accuracy.max <= 0.3);
        CHECK(structure_label(row.setting) == row.setting.structure + ", δ <= 0.3");
    }
}

TEST_CASE("a study that cannot be run is refused before anything runs") {
    Study study = small_study({"K_L"});
    study.domain = Box{Point::Constant(0), Point::Constant(1)};
    CHECK_THROWS_AS(PreparedStudy(study, tree_catalogue()), InputError);
    study = small_study({"K_L"});
    study.runs[0].kd_depth = {1000};
    CHECK_THROWS_AS(PreparedStudy(study, tree_catalogue()), InputError);
    study = small_study({"K_L"});
    study.sources = {.kind = SourcesKind::file, .file = "no/such/file.csv"};
    CHECK_THROWS_WITH(PreparedStudy(study, tree_catalogue()), Contains("no/such/file.csv"));
}

TEST_CASE("with a field, trees are adapted to it and the sources; without a target they say so") {
    Study study = small_study({"K_V", "K_oL"});
    study.sources.field.lengths = {.across = 0.1, .along = 0.4};
    study.runs[0].field = {FieldKind::planes};
    study.runs[0].target_delta = {0, 0.3};
    const auto check = [&](bool has_sources) {
        const auto rows = run(study, tree_catalogue());
        REQUIRE(rows.size() == 4);
        for (const Row& row : rows) {
            INFO(structure_label(row.setting) << ": " << row.error);
            CHECK((row.sources > 100) == has_sources);
            if (!row.setting.target_delta) {
                CHECK_THAT(row.error, Contains("target_delta"));
                continue;
            }
            REQUIRE(row.measures);
            CHECK(row.measures->footprint.control_nodes > 8);
            CHECK(row.measures->accuracy.max <= 0.3);
            CHECK((row.measures->source_accuracy > 0) == has_sources);
        }
    };
    check(true);
    study.sources.kind = SourcesKind::none;
    study.sources.h = SourcesChoice{}.h;
    check(false);
}

TEST_CASE("frozen trees answer alike, in less memory; what cannot be frozen is as it was") {
    Study study = small_study({"K_oV", "K_LA"});
    study.runs[0].frozen = {Frozen::no, Frozen::doubles, Frozen::floats};
    const auto trees = tree_catalogue();
    std::vector<CatalogueEntry> catalogue(trees.begin(), trees.end());
    const auto anchored = anchored_catalogue();
    catalogue.insert(catalogue.end(), anchored.begin(), anchored.end());
    const auto rows = run(study, catalogue);
    REQUIRE(rows.size() == 4);
    for (const Row& row : rows) REQUIRE(row.measures);
    CHECK(structure_label(rows[2].setting) == "K_oV, frozen with floats");
    const auto bytes = [&](std::size_t i) { return rows[i].measures->footprint.bytes_total(); };
    CHECK(rows[1].measures->access_random.checksum == rows[0].measures->access_random.checksum);
    CHECK(rows[2].measures->access_random.checksum != rows[0].measures->access_random.checksum);
    CHECK(rows[2].measures->accuracy.max == Approx(rows[0].measures->accuracy.max).epsilon(1e-4));
    CHECK(bytes(1) < bytes(0));
    CHECK(bytes(2) < bytes(1));
    CHECK(rows[3].setting.structure == "K_LA");
}

TEST_CASE("with the reference at their nodes, structures err between nodes only") {
    Study study = small_study({"K_oV", "K_LA"});
    study.runs[0].node_values = {NodeValues::graded, NodeValues::exact};
    const auto trees = tree_catalogue();
    std::vector<CatalogueEntry> catalogue(trees.begin(), trees.end());
    const auto anchored = anchored_catalogue();
    catalogue.insert(catalogue.end(), anchored.begin(), anchored.end());
    const auto rows = run(study, catalogue);
    REQUIRE(rows.size() == 3);  // K_LA holds no metrics
    const auto graded = std::find_if(rows.begin(), rows.end(), [](const Row& row) {
        return structure_label(row.setting) == "K_oV";
    });
    const auto exact = std::find_if(rows.begin(), rows.end(), [](const Row& row) {
        return structure_label(row.setting) == "K_oV, exact at nodes";
    });
    REQUIRE(graded != rows.end());
    REQUIRE(exact != rows.end());
    CHECK(exact->measures->accuracy.mean < 0.8 * graded->measures->accuracy.mean);
    CHECK(exact->measures->footprint.bytes_total() == graded->measures->footprint.bytes_total());
}
