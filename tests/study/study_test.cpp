// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/study.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "cli/paper_reference.h"
#include "controlspace/error.h"
#include "controlspace/study/workload.h"
#include "data_folder.h"

namespace controlspace::study_test {

using Catch::Matchers::Contains;

namespace {

/// The trees and something that is none.
std::vector<CatalogueEntry> catalogue_with_a_grid() {
    const auto trees = tree_catalogue();
    std::vector<CatalogueEntry> entries(trees.begin(), trees.end());
    entries.push_back({.id = "grid", .description = "", .capabilities = {MetricNodes()}});
    return entries;
}

std::vector<Case> expand(const Study& study) {
    const auto catalogue = catalogue_with_a_grid();
    return expand(study, {catalogue, program_parameters()});
}

Study study_of(Values structures) {
    Study study;
    study.runs[0]["structures"] = std::move(structures);
    return study;
}

}  // namespace

TEST_CASE("splits multiply kd-trees only, depths those that have them") {
    Study study = study_of({"K_L", "K_oV", "grid"});
    study.runs[0]["kd_depth"] = {42, 100};
    study.runs[0]["octree_depth"] = {14, 13, 12};
    const auto cases = expand(study);
    REQUIRE(cases.size() == 3 * 2 + 3 + 1);
    CHECK(cases[0].split == SplitRule::middle);
    CHECK(cases[0].max_depth == 42);
    CHECK(cases[1].max_depth == 100);
    CHECK(cases[6].structure == "K_oV");
    CHECK_FALSE(cases[6].split);
    CHECK(cases[8].max_depth == 12);
    CHECK(cases[9].structure == "grid");
    CHECK_FALSE(cases[9].max_depth);
}

TEST_CASE("voxels and pruning multiply the grids that have them") {
    std::vector<CatalogueEntry> catalogue = catalogue_with_a_grid();
    catalogue.push_back(
        {.id = "flat", .description = "", .capabilities = {MetricNodes(), VoxelSize()}});
    catalogue.push_back({.id = "pruned",
                         .description = "",
                         .capabilities = {MetricNodes(), VoxelSize(), Pruning()},
                         .former_id = "sparse"});
    Study study = study_of({"K_oL", "grid", "flat", "sparse"});
    study.runs[0]["voxel"] = {0, 0.5};
    study.runs[0]["prune_delta"] = {0, 0.1};
    const auto cases = expand(study, {catalogue});
    REQUIRE(cases.size() == 1 + 1 + 2 + 2 * 2);
    CHECK_FALSE(cases[2].voxel);
    CHECK(cases[3].voxel == 0.5);
    CHECK(cases[3].structure == "flat");
    CHECK(structure_label(cases[3]) == "flat, voxel 0.5");
    CHECK(structure_label(cases[4]) == "pruned");
    CHECK_FALSE(cases[4].prune_delta);
    CHECK(structure_label(cases.back()) == "pruned, voxel 0.5, pruned at 0.1");
}

TEST_CASE("interpolation multiplies trees with quadratic leaves only") {
    Study study = study_of({"K_L", "K_Li", "K_oLi", "grid"});
    study.runs[0]["splits"] = {"s_L"};
    study.runs[0]["interpolation"] = {"corrected", "published"};
    const auto cases = expand(study);
    REQUIRE(cases.size() == 1 + 2 + 2 + 1);
    CHECK_FALSE(cases[0].interpolation);
    CHECK(structure_label(cases[1]) == "K_Li s_L");
    CHECK(structure_label(cases[2]) == "K_Li s_L, published interpolation");
    const Workload workload = make_workload(study, cases[0].sources);
    CHECK(space_options(study, cases[1], workload).quadratic_form == QuadraticForm::corrected);
    CHECK(space_options(study, cases[2], workload).quadratic_form == QuadraticForm::published);
}

TEST_CASE("goals that voxels are chosen for multiply grids, neighbours what holds metrics") {
    std::vector<CatalogueEntry> catalogue = catalogue_with_a_grid();
    catalogue.push_back(
        {.id = "flat", .description = "", .capabilities = {MetricNodes(), VoxelSize()}});
    catalogue.push_back({.id = "keeper", .description = "", .capabilities = {KeptSources()}});
    Study study = study_of({"K_oL", "flat", "keeper"});
    study.runs[0]["equal_delta"] = {0, 0.1};
    study.runs[0]["neighbourhood"] = {"faces", "all"};
    const auto cases = expand(study, {catalogue});
    REQUIRE(cases.size() == 2 + 4 + 1);
    CHECK(structure_label(cases[1]) == "K_oL, all neighbours");
    CHECK(structure_label(cases[5]) == "flat, for delta 0.1, all neighbours");
    study.runs[0]["equal_memory"] = {5};
    CHECK_THROWS_WITH(expand(study, {catalogue}), Contains("give one of them"));
}

TEST_CASE("lists expand to their product, rho outermost and structures innermost") {
    Study study = study_of({"K_oL", "grid"});
    study.runs[0]["rho"] = {1, 0.2};
    study.runs[0]["tau"] = {1, 0.5, 0.2};
    study.runs[0]["law"] = {"cone", "mean-length"};
    const auto cases = expand(study);
    REQUIRE(cases.size() == 2 * 3 * 2 * 2);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        CHECK(cases[i].structure == (i % 2 == 0 ? "K_oL" : "grid"));
        CHECK(cases[i].tau == study.runs[0]["tau"][i / 2 % 3].number());
        CHECK(name_of(cases[i].law) == study.runs[0]["law"][i / 6 % 2].text());
        CHECK(cases[i].sources.rho == study.runs[0]["rho"][i / 12].number());
    }
}

TEST_CASE("groups name many structures, and nothing is run twice") {
    CHECK(expand(study_of({"trees"})).size() == 3 * 3 + 3);
    CHECK(expand(study_of({"baselines"})).size() == 1);
    CHECK(expand(study_of({"all"})).size() == 3 * 3 + 3 + 1 + 1);
    CHECK(expand(study_of({"all", "trees", "K_L"})).size() == 3 * 3 + 3 + 1 + 1);
    Study twice = study_of({"K_L"});
    twice.runs.push_back(twice.runs[0]);
    CHECK(expand(twice).size() == 3);
}

TEST_CASE("the paper's study has its 72 rows as published, and all structures by default") {
    const auto cases =
        expand(read_study(data_folder() / "studies/paper-sphere.toml", program_parameters()));
    std::size_t published = 0;
    for (const Case& c : cases) published += c.reference == &published_sphere() ? 1 : 0;
    CHECK(published == 72);
    CHECK(cases.size() == 72 + 78 + 6);
    std::set<std::pair<double, double>> settings;
    for (const Case& c : cases) settings.emplace(c.sources.rho, c.tau);
    CHECK(settings.size() == 6);
}

TEST_CASE("studies that make no sense are refused") {
    CHECK_THROWS_WITH(expand(study_of({"K_X"})),
                      Contains("unknown structure 'K_X'") && Contains("K_oLB") && Contains("grid"));
    CHECK_THROWS_AS(expand(study_of({})), InputError);

    Study study = study_of({"K_L"});
    study.sources.kind = SourcesKind::file;
    CHECK_NOTHROW(expand(study));
    study.runs[0]["rho"] = {0.5};
    CHECK_THROWS_WITH(expand(study), Contains("rho is for sampled surfaces"));
    study.runs[0]["rho"] = {1};
    study.sources.radius = 0.5;
    CHECK_THROWS_WITH(expand(study), Contains("radius is for the sphere"));
    study.sources.radius = SourcesChoice{}.radius;
    study.sources.slope = 0.5;
    CHECK_THROWS_WITH(expand(study), Contains("slope is for the planes"));
    study.sources.slope = SourcesChoice{}.slope;
    study.runs[0]["reference"] = {"published-sphere"};
    CHECK_THROWS_WITH(expand(study), Contains("for the sphere"));
    study.sources.kind = SourcesKind::sphere;
    CHECK_NOTHROW(expand(study));
    study.runs[0]["s_n"] = {1, std::nextafter(1.0, 2.0)};
    CHECK_NOTHROW(expand(study));
    study.runs[0]["s_n"] = {1, 1.001};
    CHECK_THROWS_WITH(expand(study), Contains("isotropic"));

    Study huge = study_of({"K_L"});
    huge.runs[0]["rho"].assign(1000, 1);
    huge.runs[0]["tau"].assign(1000, 1);
    CHECK_THROWS_WITH(expand(huge), Contains("more than 5000 cases"));
}

TEST_CASE("samplings and fields multiply all structures") {
    Study study = study_of({"K_oL", "grid"});
    study.runs[0]["field"] = {"none", "ugawg-linear"};
    study.runs[0]["sampling"] = {"regular", "random", "clustered"};
    const auto cases = expand(study);
    REQUIRE(cases.size() == 2 * 3 * 2);
    std::set<std::string> tables;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        CHECK(name_of(cases[i].sources.field.kind) == study.runs[0]["field"][i / 6].text());
        CHECK(name_of(cases[i].sources.sampling) == study.runs[0]["sampling"][i / 2 % 3].text());
        tables.insert(setting_label(cases[i]));
    }
    CHECK(tables.size() == 6);
    CHECK(tables.count("field ugawg-linear, random sources, rho 1, s_a 2, s_n 1, g_r 1.25, exact "
                       "reference, cone law, sources, epsilon 0.2, tau 1") == 1);
}

TEST_CASE("fields and sources that do not fit together are refused") {
    const auto complaint = [](auto&& change) -> std::string {
        Study study = study_of({"grid"});
        change(study.sources, study.runs[0]);
        try {
            expand(study);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(complaint([](SourcesChoice&, Run&) {}).empty());
    CHECK(complaint([](SourcesChoice& s, Run& run) {
              s.kind = SourcesKind::none;
              run["field"] = {"ugawg-linear"};
          }).empty());
    CHECK_THAT(complaint([](SourcesChoice& s, Run&) { s.kind = SourcesKind::none; }),
               Contains("neither sources nor a field"));
    CHECK_THAT(complaint([](SourcesChoice& s, Run& run) {
                   s.kind = SourcesKind::none;
                   run["field"] = {"sphere"};
                   run["sampling"] = {"random"};
               }),
               Contains("sampling is for sampled surfaces"));
    CHECK_THAT(complaint([](SourcesChoice& s, Run&) { s.field.radius = 0.5; }),
               Contains("field_radius"));
    CHECK_THAT(complaint([](SourcesChoice& s, Run& run) {
                   s.field.slope = 0.5;
                   run["field"] = {"sphere"};
               }),
               Contains("field_slope"));
    CHECK_THAT(complaint([](SourcesChoice& s, Run& run) {
                   s.field.lengths.growth = 0.5;
                   run["field"] = {"ugawg-linear"};
               }),
               Contains("field_growth"));
    CHECK_THAT(complaint([](SourcesChoice& s, Run& run) {
                   s.kind = SourcesKind::planes;
                   s.centre = Point(1, 0, 0);
                   run["field"] = {"sphere"};
               }),
               Contains("centre"));
    CHECK_THAT(complaint([](SourcesChoice&, Run& run) {
                   run["field"] = {"sphere"};
                   run["reference"] = {"published-sphere"};
               }),
               Contains("for the sphere alone"));
    CHECK_THAT(complaint([](SourcesChoice& s, Run& run) {
                   s.centre = Point(0.1, 0, 0);
                   run["reference"] = {"published-sphere"};
               }),
               Contains("around the origin"));
}

TEST_CASE("the studies of irregular sources and of fields make sense") {
    const std::filesystem::path folder = data_folder() / "studies";
    CHECK(expand(read_study(folder / "sources.toml")).size() == 3 * 4 * 8);
    CHECK(expand(read_study(folder / "fields.toml")).size() == 4 * 8);
    CHECK(expand(read_study(folder / "mixtures.toml")).size() == 2 * 8);
}

}  // namespace controlspace::study_test
