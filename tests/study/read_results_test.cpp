#include "study/read_results.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "controlspace/error.h"
#include "scratch_directory.h"
#include "study/results.h"
#include "study/row_json.h"
#include "study/sample_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;
using Json = nlohmann::ordered_json;

namespace {

/// Rows of every kind: measured, failed, without a split, with other names.
std::vector<Row> some_rows() {
    std::vector<Row> rows{sample_row(published_case()), sample_row(Case{})};
    rows[1].setting.structure = "uniform-nearest";
    rows[1].setting.split.reset();
    rows[1].setting.tau = 0.1 + 0.2;  // no short decimal
    rows[1].setting.sources.rho = 0.2;
    rows[1].setting.voxel = 0.01;
    rows[1].setting.voxel_factor = 0.7;
    rows[1].setting.prune_delta = 0.05;
    rows[1].setting.target_delta = 0.1;
    rows[1].measures->footprint.bytes_published.reset();
    rows.push_back({published_case(), 36186, std::nullopt, "out of memory, \"really\""});
    return rows;
}

Json valid_json() {
    return Json::parse(results_json(current_provenance(), Study{}, some_rows(), true));
}

}  // namespace

TEST_CASE("what was written is read back") {
    const ScratchDirectory folder;
    Study study;
    study.name = "mine";
    study.seed = 7;
    study.domain = Box{Point(-2, -1, -1), Point(1, 1.000000001, 3)};
    study.sources.radius = 0.7;
    study.sources.field.lengths = {.across = 0.01, .along = 0.5, .growth = 0, .largest = 0.75};
    auto rows = some_rows();
    for (Row& row : rows) row.setting.sources = study.sources;
    rows[0].setting.sources.sampling = Sampling::clustered;
    rows[1].setting.sources.rho = 0.2;
    rows[1].setting.sources.field.kind = FieldKind::ugawg_polar_1;
    Provenance provenance = current_provenance();
    provenance.command_line = "controlspace compare";
    ResultsFolder(folder.path()).write(provenance, study, rows, false);

    const StoredResults read = read_results(folder.path());
    CHECK_FALSE(read.complete);
    CHECK(read.study.name == "mine");
    CHECK(read.study.seed == 7);
    CHECK(read.study.domain == study.domain);
    CHECK(read.provenance.cpu == provenance.cpu);
    CHECK(read.provenance.command_line == "controlspace compare");
    REQUIRE(read.rows.size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CHECK(read.rows[i].setting == rows[i].setting);
        CHECK(to_json(read.rows[i]) == to_json(rows[i]));
    }
    CHECK(results_json(read.provenance, read.study, read.rows, false) ==
          results_json(provenance, study, rows, false));
}

TEST_CASE("results of before grids, samplings and fields had settings are read") {
    const ScratchDirectory folder;
    Json json = valid_json();
    for (Json& row : json["rows"]) {
        for (const char* field :
             {"voxel", "voxel_factor", "prune_delta", "target_delta", "sampling", "field"})
            row.erase(field);
    }
    folder.file("results.json", json.dump());
    const StoredResults read = read_results(folder.path());
    REQUIRE(read.rows.size() == some_rows().size());
    CHECK(read.rows[0].setting == some_rows()[0].setting);
    CHECK_FALSE(read.rows[1].setting.voxel);
}

TEST_CASE("what is no file of results is refused by name") {
    const ScratchDirectory folder;
    CHECK_THROWS_WITH(read_results(folder.path() / "none"), Contains("results.json"));
    CHECK_THROWS_AS(read_results(folder.path()), InputError);
    const auto refuse = [&](const std::string& text, const std::string& expected) {
        folder.file("results.json", text);
        CHECK_THROWS_AS(read_results(folder.path()), InputError);
        CHECK_THROWS_WITH(read_results(folder.path()),
                          Contains("results.json: ") && Contains(expected));
    };
    folder.file("results.json", "");
    CHECK_THROWS_WITH(read_results(folder.path()), Contains("results.json is empty"));
    refuse("{", "parse error");
    refuse("[]", "not written by this program");
    refuse("{}", "not written by this program");
    refuse("7", "not written by this program");
    Json json = valid_json();
    json["program"] = 3;
    refuse(json.dump(), "not written by this program");
    json = valid_json();
    json["schema_version"] = 99;
    refuse(json.dump(), "schema version 99");
    json = valid_json();
    json.erase("settings");
    refuse(json.dump(), "settings");
    json = valid_json();
    json["settings"]["seed"] = "x";
    refuse(json.dump(), "'x' is not a number");
    json = valid_json();
    json["settings"]["seed"] = true;
    refuse(json.dump(), "seed");
    json = valid_json();
    json["complete"] = "yes";
    refuse(json.dump(), "type");
    json = valid_json();
    json["rows"] = 3;
    refuse(json.dump(), "rows");
}

TEST_CASE("a row that is no row is refused by its number") {
    const ScratchDirectory folder;
    const auto refuse = [&](const char* field, const Json& value, const std::string& expected) {
        Json json = valid_json();
        json["rows"][1][field] = value;
        folder.file("results.json", json.dump());
        CHECK_THROWS_WITH(read_results(folder.path()), Contains("row 2: ") && Contains(expected));
    };
    refuse("split", "s_X", "unknown split 's_X'");
    refuse("law", "none", "unknown law 'none'");
    refuse("tau", "1", "type");
    refuse("leaves", nullptr, "type");
    refuse("checksum", "xyz", "no checksum");
    refuse("t_access_ns_random_samples", "1 2", "type");
    refuse("t_access_ns_random_samples", Json::array(), "no samples");
    Json json = valid_json();
    json["rows"][1].erase("delta_R_max");
    folder.file("results.json", json.dump());
    CHECK_THROWS_WITH(read_results(folder.path()), Contains("row 2: ") && Contains("delta_R_max"));
}

TEST_CASE("an infinite error is read back; what old results do not have is unknown") {
    const ScratchDirectory folder;
    auto rows = some_rows();
    rows[0].measures->accuracy.max = std::numeric_limits<double>::infinity();
    rows[0].measures->accuracy.coarser_max = std::numeric_limits<double>::infinity();
    Json json = Json::parse(results_json(current_provenance(), Study{}, rows, true));
    for (const char* field :
         {"coarser_max", "coarser_share", "coarser_fine_max", "coarser_fine_share"}) {
        json["rows"][1].erase(field);
    }
    folder.file("results.json", json.dump());
    const StoredResults read = read_results(folder.path());
    CHECK(std::isinf(read.rows[0].measures->accuracy.max));
    CHECK(std::isinf(read.rows[0].measures->accuracy.coarser_max));
    CHECK(read.rows[0].measures->accuracy.coarser_share == 0.06);
    CHECK(std::isnan(read.rows[1].measures->accuracy.coarser_max));
    CHECK(std::isnan(read.rows[1].measures->accuracy_fine.coarser_share));
}
