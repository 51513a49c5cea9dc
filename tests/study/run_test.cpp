// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <thread>

#include "cli/paper_reference.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/space/sample_parallel.h"

namespace controlspace::run_test {

using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

/// A small sphere in few probes: a second for all trees.
Study small_study(Values structures) {
    Study study;
    study.sources.h = 0.2;
    study.access_points = 1000;
    study.access_repeats = 3;
    study.creation_repeats = 2;
    study.probe_grid = 8;
    study.fine_probe_grid = 9;
    study.runs[0]["structures"] = std::move(structures);
    study.runs[0]["splits"] = {"s_L"};
    return study;
}

std::vector<double> samples(const Row& row, const std::string& key) {
    return std::get<std::vector<double>>(row.values.at(key));
}

std::vector<Row> run(const Study& study, std::span<const CatalogueEntry> catalogue) {
    return PreparedStudy(study, {catalogue}).run();
}

/// The trees, and two that cannot be made.
std::vector<CatalogueEntry> catalogue_with_failures() {
    const auto trees = tree_catalogue();
    std::vector<CatalogueEntry> entries(trees.begin(), trees.end());
    CatalogueEntry broken{.id = "broken", .description = ""};
    broken.construct = [](const SpaceOptions&) -> std::unique_ptr<ControlSpaceBuilder> {
        throw InputError("cannot be made");
    };
    entries.insert(entries.begin(), broken);
    CatalogueEntry greedy{.id = "greedy", .description = ""};
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
        REQUIRE(row.is_measured());
        CHECK(row.sources > 100);
        CHECK(row.number("sources_inserted") > 0);
        CHECK(row.number("sources_inserted") <= static_cast<double>(row.sources));
        CHECK(row.number("cells") > 1);
        CHECK(samples(row, "t_access_ns_random_samples").size() == 3);
        CHECK(samples(row, "t_insert_s_samples").size() == 2);
        CHECK(row.number("t_access_ns_grid") > 0);
        CHECK(row.number("access_batch") == 0);
        CHECK(row.number("delta_R_max") > 0);
        CHECK(row.number("delta_R_mean") < row.number("delta_R_max"));
        CHECK(row.number("gradation_max_left") < 1.2501);
    }
}

TEST_CASE("access is timed of lengths where all is isotropic, and of metrics otherwise") {
    Study study = small_study({"K_L", "K_oV"});
    const bool is_isotropic = GENERATE(true, false);
    study.runs[0]["s_n"] = {is_isotropic ? 1 : 0.5};
    std::map<std::string, std::uint64_t> sums;
    PreparedStudy prepared(study, {tree_catalogue()});
    StudyObserver observer;
    observer.case_checked = [&](const Finished& f, Row&) {
        const auto places = random_points(f.workload.domain, study.access_points, study.seed);
        sums[f.setting.structure] = checksum(sample_parallel(f.space, places));
        CHECK(f.probes.near.size() == study.access_points);
        CHECK(f.probes.walk.size() == study.access_points);
    };
    observer.case_finished = [&](const Row& row) {
        INFO(row.error);
        REQUIRE(row.is_measured());
        CHECK(row.text("answers") == (is_isotropic ? "lengths" : "metrics"));
        CHECK(row.text("checksum") == fmt::format("{:016x}", sums.at(row.setting.structure)));
        for (const char* order : {"random", "grid", "near", "single", "walk"}) {
            CHECK(row.number(std::string("t_access_ns_") + order) > 0);
        }
        for (const char* order : {"metric_random", "metric_single"}) {
            CHECK(std::isnan(row.number(std::string("t_access_ns_") + order)) == !is_isotropic);
        }
    };
    std::move(prepared).run(observer);
    CHECK(sums.size() == 2);
}

TEST_CASE("with a field alone, access is timed where the field is fine") {
    Study study = small_study({"K_oV"});
    study.sources.kind = SourcesKind::none;
    study.sources.h = SourcesChoice{}.h;
    study.sources.field.lengths = {.across = 0.1, .along = 0.1};
    study.runs[0]["field"] = {"planes"};
    study.runs[0]["target_delta"] = {0.3};
    PreparedStudy prepared(study, {tree_catalogue()});
    double at_random = 0, near = 0;
    StudyObserver observer;
    observer.case_checked = [&](const Finished& f, Row&) {
        const auto mean = [&](const std::vector<Point>& x) {
            double sum = 0;
            for (const Metric& m : sample_parallel(*f.workload.field.field, x)) sum += m.xx;
            return sum / static_cast<double>(x.size());
        };
        at_random = mean(f.probes.coarse.points);
        near = mean(f.probes.near);
    };
    std::move(prepared).run(observer);
    CHECK(near > 0);
    CHECK(near < 0.7 * at_random);
}

TEST_CASE("the same study gives the same answers") {
    const Study study = small_study({"K_L", "K_oV"});
    const auto first = run(study, tree_catalogue());
    const auto second = run(study, tree_catalogue());
    REQUIRE(first.size() == second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        CHECK(first[i].values.at("checksum") == second[i].values.at("checksum"));
        CHECK(first[i].number("delta_R_fine_mean") == second[i].number("delta_R_fine_mean"));
    }
}

TEST_CASE("structures that cannot run are rows with their reason, and others still run") {
    const auto rows = run(small_study({"all"}), catalogue_with_failures());
    REQUIRE(rows.size() == 9);
    CHECK(rows[0].error == "cannot be made");
    CHECK(rows[0].values.empty());
    CHECK(rows[1].is_measured());
    CHECK_THAT(rows[8].error, Contains("out of memory"));
}

TEST_CASE("reference and sources are made once for the cases that share them") {
    Study study = small_study({"K_L", "K_oL"});
    study.runs[0]["rho"] = {1, 0.7};
    study.runs[0]["reference"] = {"exact", "published-sphere"};
    study.runs.push_back(study.runs[0]);
    study.runs[1]["tau"] = {2};
    PreparedStudy prepared(study, {tree_catalogue(), program_parameters()});
    CHECK(prepared.cases().size() == 16);
    CHECK(std::set<std::size_t>(prepared.source_counts().begin(), prepared.source_counts().end())
              .size() == 2);
    std::map<std::string_view, int> phases;
    std::size_t failed = 0;
    StudyObserver observer;
    observer.phase_started = [&](std::string_view phase) { ++phases[phase]; };
    observer.case_finished = [&](const Row& row) { failed += row.is_measured() ? 0 : 1; };
    std::move(prepared).run(observer);
    CHECK(failed == 0);
    CHECK(phases["reference field"] == 4);
    CHECK(phases["insertion"] == 2 * 16);
}

TEST_CASE("with a target, trees are adapted, once for all rules, and say what they reached") {
    Study study = small_study({"K_V", "K_oL"});
    study.runs[0]["splits"] = {"s_L", "s_G"};
    study.runs[0]["target_delta"] = {0, 0.3};
    const auto rows = run(study, tree_catalogue());
    REQUIRE(rows.size() == 5);
    for (const Row& row : rows) {
        REQUIRE(row.is_measured());
        const std::string remark = std::get<std::string>(row.values.at("remark"));
        if (!row.setting.target_delta) {
            CHECK(remark.empty());
            continue;
        }
        CHECK(remark.find("lengths within") != std::string::npos);
        CHECK(row.number("delta_R_max") <= 0.3);
        CHECK(structure_label(row.setting) == row.setting.structure + ", δ <= 0.3");
    }
}

TEST_CASE("a study that cannot be run is refused before anything runs") {
    Study study = small_study({"K_L"});
    study.domain = Box{Point::Constant(0), Point::Constant(1)};
    CHECK_THROWS_AS(PreparedStudy(study, {tree_catalogue()}), InputError);
    study = small_study({"K_L"});
    study.runs[0]["kd_depth"] = {1000};
    CHECK_THROWS_AS(PreparedStudy(study, {tree_catalogue()}), InputError);
    study = small_study({"K_L"});
    study.sources = {.kind = SourcesKind::file, .files = {"no/such/file.csv"}};
    CHECK_THROWS_WITH(PreparedStudy(study, {tree_catalogue()}), Contains("no/such/file.csv"));
}

TEST_CASE(
    "with a field, trees are adapted to it and the sources, and without a target they say so") {
    Study study = small_study({"K_V", "K_oL"});
    study.sources.field.lengths = {.across = 0.1, .along = 0.4};
    study.runs[0]["field"] = {"planes"};
    study.runs[0]["target_delta"] = {0, 0.3};
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
            REQUIRE(row.is_measured());
            CHECK(row.number("control_nodes") > 8);
            CHECK(row.number("delta_R_max") <= 0.3);
            CHECK((row.number("delta_S_max") > 0) == has_sources);
        }
    };
    check(true);
    study.sources.kind = SourcesKind::none;
    study.sources.h = SourcesChoice{}.h;
    check(false);
}

TEST_CASE("precisions answer alike, in less memory, and what has no choice is as it was") {
    Study study = small_study({"K_oV", "K_LA"});
    study.runs[0]["precision"] = {"as-made", "double", "float", "log16"};
    const auto trees = tree_catalogue();
    std::vector<CatalogueEntry> catalogue(trees.begin(), trees.end());
    const auto anchored = anchored_catalogue();
    catalogue.insert(catalogue.end(), anchored.begin(), anchored.end());
    const auto rows = run(study, catalogue);
    REQUIRE(rows.size() == 5);
    for (const Row& row : rows) REQUIRE(row.is_measured());
    CHECK(structure_label(rows[2].setting) == "K_oV, float");
    CHECK(structure_label(rows[3].setting) == "K_oV, log16");
    const auto bytes = [&](std::size_t i) { return rows[i].number("bytes_total"); };
    const auto sum = [&](std::size_t i) { return rows[i].values.at("checksum"); };
    CHECK(sum(1) == sum(0));
    CHECK(sum(2) != sum(0));
    CHECK(rows[2].number("delta_R_max") == Approx(rows[0].number("delta_R_max")).epsilon(1e-4));
    CHECK(bytes(1) < bytes(0));
    CHECK(bytes(2) < bytes(1));
    CHECK(bytes(3) < bytes(2));
    CHECK(rows[4].setting.structure == "K_LA");
}

TEST_CASE("graded by the sources, structures err between nodes only") {
    Study study = small_study({"K_oL", "K_oV"});
    study.runs[0]["schedule"] = {"queue", "sources"};
    const auto rows = run(study, tree_catalogue());
    REQUIRE(rows.size() == 4);
    const auto row = [&](const char* structure, GradationSchedule schedule) -> const Row& {
        return *std::ranges::find_if(rows, [&](const Row& r) {
            return r.setting.structure == structure && r.setting.schedule == schedule;
        });
    };
    const Row& queue = row("K_oV", GradationSchedule::queue);
    const Row& sources = row("K_oV", GradationSchedule::sources);
    CHECK(sources.number("delta_R_mean") < 0.8 * queue.number("delta_R_mean"));
    const Row& leaves = row("K_oL", GradationSchedule::sources);
    CHECK(sources.number("cells") == leaves.number("cells"));
    CHECK(leaves.number("bytes_total") ==
          row("K_oL", GradationSchedule::queue).number("bytes_total"));
}

TEST_CASE("the ratio left is that of the law and of the neighbours that were graded by") {
    // Of this law the exact field knows nothing: both schedules grade from node to node.
    for (const char* neighbourhood : {"faces", "all"}) {
        CAPTURE(neighbourhood);
        Study study = small_study({"K_oV"});
        study.runs[0]["schedule"] = {"queue", "sources"};
        study.runs[0]["law"] = {"mean-length"};
        study.runs[0]["neighbourhood"] = {neighbourhood};
        const auto rows = run(study, tree_catalogue());
        REQUIRE(rows.size() == 2);
        CHECK(rows[1].number("delta_R_mean") == rows[0].number("delta_R_mean"));
        CHECK(rows[1].number("gradation_max_left") == rows[0].number("gradation_max_left"));
    }
}

TEST_CASE("rows say which settings have no effect, and these have none") {
    struct Given {
        const char* key;
        Value value;
        const char* schedule = "sources";
    };
    // Far from the defaults, so that what has an effect shows it.
    const Given given = GENERATE(values<Given>({{"law", "mean-length"},
                                                {"schedule", "queue"},
                                                {"epsilon", 1e-4},
                                                {"tau", 0.5},
                                                {"splits", "s_Gx"},
                                                {"kd_depth", 3},
                                                {"octree_depth", 1},
                                                {"interpolation", "published"},
                                                {"target_delta", 0.02},
                                                {"equal_delta", 0.5},
                                                {"equal_memory", 0.1},
                                                {"voxel", 0.3},
                                                {"neighbourhood", "all", "queue"},
                                                {"precision", "float"},
                                                {"prune_delta", 0.5}}));
    CAPTURE(given.key);
    Study study = small_study({"all"});
    study.sources.h = 0.3;
    study.access_points = 300;
    study.creation_repeats = 1;
    study.fine_probe_grid = 5;
    study.runs[0]["schedule"] = {given.schedule};
    static std::map<std::string, std::vector<Row>> known;
    std::vector<Row>& before = known[given.schedule];
    if (before.empty()) before = run(study, structures());
    study.runs[0][given.key] = {given.value};
    const auto after = run(study, structures());
    REQUIRE(after.size() == before.size());
    std::size_t without = 0, changed = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
        const Row &a = before[i], &b = after[i];
        CAPTURE(b.setting.structure, b.text("remark"), b.error);
        REQUIRE(b.setting.structure == a.setting.structure);
        REQUIRE(b.is_measured());
        const bool is_same = b.text("checksum") == a.text("checksum") &&
                             b.number("bytes_total") == a.number("bytes_total") &&
                             b.number("gradation_max_left") == a.number("gradation_max_left");
        const std::string remark = b.text("remark");
        const std::size_t list = remark.find("without effect: ");
        const bool is_remarked =
            list != std::string::npos && remark.find(given.key, list) != std::string::npos;
        if (is_remarked) CHECK(is_same);
        without += is_remarked;
        changed += !is_same;
    }
    CHECK(changed > 0);
    CHECK(without + changed >= after.size() / 2);
    if (given.key == std::string("target_delta")) {
        // All but the sources themselves can be adapted.
        CHECK(without == 1);
    }
}

TEST_CASE("a setting that a run gives to other structures is not remarked on") {
    Study study = small_study({"K_oV"});
    study.runs[0] = {{"structures", {"K_oV"}}, {"target_delta", {0.1}}, {"tau", {0.5}}};
    study.runs.push_back({{"structures", {"direct"}}, {"tau", {0.5}}});
    auto rows = run(study, structures());
    REQUIRE(rows.size() == 2);
    CHECK_THAT(rows[0].text("remark"), EndsWith("without effect: tau"));
    CHECK_THAT(rows[1].text("remark"), EndsWith("without effect: tau"));
    study.runs[1]["target_delta"] = {0.1, 0.2};
    rows = run(study, structures());
    REQUIRE(rows.size() == 2);
    CHECK_THAT(rows[1].text("remark"), EndsWith("without effect: tau, target_delta (within)"));
}

TEST_CASE("a row remarks on a gradation that was not reached") {
    Study study = small_study({"K_V", "K_oL"});
    study.runs[0]["schedule"] = {"queue", "passes"};
    study.runs[0]["splits"] = {"s_M"};
    study.runs[0]["g_r"] = {1.25, 1.02};
    std::size_t above = 0;
    for (const Row& row : run(study, tree_catalogue())) {
        CAPTURE(row.setting.structure, row.setting.g_r, row.number("gradation_max_left"));
        const bool is_above = row.number("gradation_max_left") > row.setting.g_r + 1e-4;
        CHECK(Contains("G left").match(row.text("remark")) == is_above);
        above += is_above;
    }
    CHECK(above > 0);
}

TEST_CASE("a row shows where the probes found more than adaptation states") {
    // Of quadratic leaves and of tensors nothing is bounded.
    Study study = small_study({"K_Li", "K_oV", "K_V"});
    study.sources.s_n = GENERATE(1.0, 0.1);
    study.fine_probe_grid = 41;
    study.runs[0]["target_delta"] = {0.3};
    std::size_t stated = 0;
    for (const Row& row : run(study, tree_catalogue())) {
        CAPTURE(row.setting.structure, row.text("remark"));
        const double found = std::max(row.number("within_max"), row.number("within_fine_max"));
        const std::string remark = row.text("remark");
        const std::size_t place = remark.find("lengths within ");
        REQUIRE(place != std::string::npos);
        const double states = std::stod(remark.substr(place + 15));
        CHECK(Contains("the probes found more").match(remark) == (found > states * 1.0005));
        ++stated;
    }
    CHECK(stated == 3);
}

TEST_CASE("a row whose making a limit of time ends says how far it came, and is not ranked") {
    Study study = small_study({"K_oV", "K_oLA", "uniform-nearest"});
    study.max_seconds = 1e-6;
    study.runs[0]["target_delta"] = {0.01};
    study.runs[0]["equal_delta"] = {0.5};
    auto rows = run(study, structures());
    REQUIRE(rows.size() == 3);
    for (std::size_t i = 0; i < 2; ++i) {
        REQUIRE(rows[i].is_measured());
        CHECK_FALSE(rows[i].is_ranked());
        CHECK_FALSE(rows[i].is_as_requested());
        CHECK_THAT(rows[i].text("stopped"),
                   Contains("stopped at 1e-06 s, 1 leaves, δ ") && EndsWith(" reached"));
        CHECK_THAT(rows[i].text("remark"), Contains(rows[i].text("stopped")));
        CHECK(samples(rows[i], "t_insert_s_samples").size() == 1);
    }
    CHECK(rows[2].error == "stopped at 1e-06 s");
    study.runs[0]["target_delta"] = {0};
    rows = run(study, structures());
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK_THAT(rows[i].error, Contains("stopped at 1e-06 s, ") && EndsWith(" leaves"));
    }
    // One that is not reached leaves all as it was.
    study.max_seconds = 0;
    const auto free = run(study, structures());
    study.max_seconds = 1e6;
    study.max_memory_ratio = 1e6;
    rows = run(study, structures());
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(rows[i].is_ranked());
        CHECK(rows[i].text("checksum") == free[i].text("checksum"));
        CHECK(samples(rows[i], "t_insert_s_samples").size() == 2);
    }
}

namespace {

/// Takes longer than a limit of time allows for the first of the probes of its accuracy.
struct SlowOnce final : ControlSpace {
    static constexpr int cells = 8;  // along an axis, of small_study's probes

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        const Point first = box.low + box.edges() / (2 * cells);
        if ((x.front() - first).norm() < 1e-9)
            std::this_thread::sleep_for(std::chrono::milliseconds(1100));
        std::ranges::fill(out, Metric::isotropic(1));
    }
    Box domain() const override { return box; }

    explicit SlowOnce(const Box& domain) : box(domain) {}
    Box box;
};

struct SlowOnceBuilder final : ControlSpaceBuilder {
    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource>) override { return {}; }
    GradationReport grade(const GradationOptions&) override { return {}; }
    AdaptationReport adapt(const AdaptationGoal&) override { return {}; }
    std::unique_ptr<ControlSpace> build(const BuildOptions&) override {
        return std::make_unique<SlowOnce>(box);
    }
    Box domain() const override { return box; }

    explicit SlowOnceBuilder(const Box& domain) : box(domain) {}
    Box box;
};

}  // namespace

TEST_CASE("a row whose accuracy takes too long is stopped") {
    CatalogueEntry slow{.id = "slow", .description = ""};
    slow.construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
        return std::make_unique<SlowOnceBuilder>(options.domain);
    };
    Study study = small_study({"slow"});
    const std::vector<CatalogueEntry> catalogue{slow};
    CHECK(run(study, catalogue)[0].error.empty());
    study.max_seconds = 0.1;
    CHECK(run(study, catalogue)[0].error == "stopped at 0.1 s of measuring its accuracy");
}

TEST_CASE("a row far larger than the smallest before it is stopped, and is not ranked") {
    Study study = small_study({"K_L", "uniform-nearest", "K_oL"});
    study.max_memory_ratio = 2;
    study.runs[0]["voxel"] = {0.02};
    study.runs.push_back({{"structures", {"K_oL"}}, {"target_delta", {0.0005}}});
    const auto rows = run(study, structures());
    REQUIRE(rows.size() == 4);
    // The smallest takes less than half of that.
    const std::string at = "stopped at 4 MiB, ";
    for (const Row& row : rows) {
        INFO(row.setting.structure << row.error);
        REQUIRE(row.is_measured());
        const bool is_large =
            row.setting.structure == "uniform-nearest" || row.setting.target_delta;
        CHECK(row.is_ranked() == !is_large);
        if (!is_large) continue;
        CHECK_THAT(row.text("stopped"), Contains(at));
        // Of the finished form; a tree grows by leaves that are as large as they happen to be.
        const bool is_grid = row.setting.structure == "uniform-nearest";
        CHECK(row.number("bytes_total") <= (is_grid ? 1.01 : 2) * 4 * 1024 * 1024);
        CHECK(row.number("bytes_total") > (is_grid ? 0.9 : 0.3) * 4 * 1024 * 1024);
    }
}

TEST_CASE("structures that answer otherwise when made again have no times") {
    CatalogueEntry moody{.id = "moody", .description = "", .capabilities = {MetricNodes()}};
    static int made;  // `construct` is a plain function
    made = 0;
    moody.construct = [](const SpaceOptions& options) {
        auto builder = find_entry(tree_catalogue(), "K_oL")->make(options);
        if (made++ == 1) builder->insert(PointSource{Point::Zero(), Metric::isotropic(0.01)});
        return builder;
    };
    const auto rows = run(small_study({"moody"}), std::vector{moody});
    REQUIRE(rows.size() == 1);
    CHECK_THAT(rows[0].error, Contains("other answers"));
    CHECK(rows[0].values.empty());
}

TEST_CASE("rows are timed in batches of cases that share their probes") {
    Study study = small_study({"K_L", "K_oL"});
    study.runs[0]["tau"] = {1, 1.01};
    study.runs[0]["g_r"] = {1.25, 1.5};
    study.runs[0]["precision"] = {"as-made"};  // as large as what making them takes
    const auto rows = run(study, tree_catalogue());
    REQUIRE(rows.size() == 8);
    for (std::size_t i = 0; i < 8; ++i) CHECK(rows[i].number("access_batch") == (i < 4 ? 0 : 4));
    double largest = 0;
    for (const Row& row : rows) largest = std::max(largest, row.number("bytes_total"));
    study.max_memory_gib = 5 * largest / (1024 * 1024 * 1024.0);
    std::set<double> batches;
    for (const Row& row : run(study, tree_catalogue())) {
        INFO(row.error);
        REQUIRE(row.is_measured());
        batches.insert(row.number("access_batch"));
    }
    CHECK(batches.size() > 2);
}

TEST_CASE("a study takes rows of measures and parameters from outside") {
    std::vector<Measure> more(measures().begin(), measures().end());
    more.push_back({"nodes_per_cell", "", [](const Finished& f) -> MeasuredValue {
                        return static_cast<double>(f.footprint.control_nodes) /
                               static_cast<double>(f.footprint.cells);
                    }});
    std::vector<CaseParameter> parameters(case_parameters().begin(), case_parameters().end());
    CaseParameter stretch{{"stretch", "", "factor of l_min", other_number("stretch", positive)}};
    stretch.role = Role::structure;
    stretch.defaults = {1, 2};
    stretch.apply = [](const Case& c, SpaceOptions& o) {
        o.l_min *= c.other.at("stretch").number();
    };
    stretch.label = [](const Case& c) { return "stretch " + to_string({c.other.at("stretch")}); };
    parameters.push_back(stretch);
    const std::vector<Row> rows =
        PreparedStudy(small_study({"K_oL"}), {tree_catalogue(), parameters, more}).run();
    REQUIRE(rows.size() == 2);
    CHECK(structure_label(rows[1].setting, parameters) == "K_oL, stretch 2");
    CHECK(rows[1].number("cells") < rows[0].number("cells"));
    CHECK(rows[0].number("nodes_per_cell") == 1);
}

}  // namespace controlspace::run_test
