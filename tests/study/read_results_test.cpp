// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "controlspace/error.h"
#include "controlspace/study/results.h"
#include "scratch_directory.h"
#include "study/results_json.h"
#include "study/sample_rows.h"

namespace controlspace::read_results_test {

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
    rows[1].setting.prune_delta = 0.05;
    rows[1].setting.target_delta = 0.1;
    rows[1].setting.interpolation = QuadraticForm::published;
    rows[1].values["tree_nodes"] = MeasuredValue();
    rows[1].fields = FieldFiles{{Point(0, 1, 2), Point(3, 4, 5)}, 1, "a", "b", "", "d", "e"};
    rows.push_back(failed_row());
    return rows;
}

const StudyRows rows_of_trees = tree_rows();

void write(const std::filesystem::path& folder, const Provenance& provenance, const Study& study,
           std::vector<Row> rows, bool complete) {
    ResultsFolder(folder, provenance, study, rows_of_trees, std::move(rows)).finish(complete);
}

Json valid_json() {
    const ScratchDirectory folder;
    write(folder.path(), current_provenance(), Study{}, some_rows(), true);
    return Json::parse(file_text(folder.path() / "results.json"));
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
    write(folder.path(), provenance, study, rows, false);
    const std::string text = file_text(folder.path() / "results.json");

    const StoredResults read = read_results(folder.path(), rows_of_trees);
    CHECK_FALSE(read.complete);
    CHECK(read.study.name == "mine");
    CHECK(read.study.seed == 7);
    CHECK(read.study.domain == study.domain);
    CHECK(read.provenance.cpu == provenance.cpu);
    CHECK(read.provenance.command_line == "controlspace compare");
    REQUIRE(read.rows.size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CHECK(read.rows[i].setting == rows[i].setting);
        CHECK(to_json(read.rows[i], rows_of_trees) == to_json(rows[i], rows_of_trees));
    }
    write(folder.path(), read.provenance, read.study, read.rows, false);
    CHECK(file_text(folder.path() / "results.json") == text);
}

TEST_CASE("of an earlier program's results the access times that it did not measure are none") {
    const ScratchDirectory folder;
    Json json = valid_json();
    for (Json& row : json["rows"]) {
        for (const char* order : {"near", "walk", "metric_random", "metric_single"}) {
            for (const char* end : {"", "_q1", "_q3", "_samples"}) {
                REQUIRE(row.erase(std::string("t_access_ns_") + order + end) == 1);
            }
        }
        REQUIRE(row.erase("answers") == 1);
    }
    folder.file("results.json", json.dump());
    const auto rows = read_results(folder.path(), rows_of_trees).rows;
    CHECK(rows[0].number("t_access_ns_random") == 51);
    CHECK(std::isnan(rows[0].number("t_access_ns_near")));
    CHECK(to_json(rows[0], rows_of_trees)["answers"].is_null());
}

TEST_CASE("of results that were torn the whole rows are read") {
    const ScratchDirectory folder;
    const Study study;
    auto rows = some_rows();
    for (Row& row : rows) row.setting.sources = study.sources;
    write(folder.path(), current_provenance(), study, rows, true);
    const std::string text = file_text(folder.path() / "results.json");
    const std::size_t begin = text.find("\n \"rows\": [");
    // Where each row is whole.
    std::vector<std::size_t> ends;
    for (std::size_t end = begin; ends.size() < rows.size();) {
        const std::size_t next = text.find("\n  {", end);
        end = text.find('\n', next + 1);
        ends.push_back(end - (text[end - 1] == ',' ? 1 : 0));
    }
    for (std::size_t size = text.find("\n  {", begin) + 4; size + 2 < text.size(); size += 41) {
        folder.file("results.json", text.substr(0, size));
        const StoredResults read = read_results(folder.path(), rows_of_trees);
        CAPTURE(size, text.size());
        CHECK_FALSE(read.complete);
        // The last row counts as soon as the next begins.
        const auto whole = std::ranges::count_if(ends, [&](std::size_t e) { return e <= size; });
        CHECK(static_cast<std::ptrdiff_t>(read.rows.size()) <= whole);
        CHECK(static_cast<std::ptrdiff_t>(read.rows.size()) >= whole - 1);
        for (std::size_t i = 0; i < read.rows.size(); ++i) {
            CHECK(to_json(read.rows[i], rows_of_trees) == to_json(rows[i], rows_of_trees));
        }
    }
    // Of a row that was written over the end before it.
    folder.file("results.json",
                text.substr(0, ends[0]) + ",\n  {\"structure\": \"K_" + "omplete\": false\n}\n");
    CHECK(read_results(folder.path(), rows_of_trees).rows.size() == 1);
}

TEST_CASE("what is no file of results is refused by name") {
    const ScratchDirectory folder;
    CHECK_THROWS_WITH(read_results(folder.path() / "none", rows_of_trees),
                      Contains("results.json"));
    CHECK_THROWS_AS(read_results(folder.path(), rows_of_trees), InputError);
    const auto refuse = [&](const std::string& text, const std::string& expected) {
        folder.file("results.json", text);
        CHECK_THROWS_AS(read_results(folder.path(), rows_of_trees), InputError);
        CHECK_THROWS_WITH(read_results(folder.path(), rows_of_trees),
                          Contains("results.json: ") && Contains(expected));
    };
    folder.file("results.json", "");
    CHECK_THROWS_WITH(read_results(folder.path(), rows_of_trees),
                      Contains("results.json is empty"));
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
        CHECK_THROWS_WITH(read_results(folder.path(), rows_of_trees),
                          Contains("row 2: ") && Contains(expected));
    };
    refuse("split", "s_X", "split: unknown value 's_X'");
    refuse("law", "none", "law: unknown value 'none'");
    refuse("tau", "1", "tau: '1' is not a number");
    refuse("cells", Json::object(), "type");
    refuse("t_access_ns_random_samples", Json{"1", "2"}, "type");
    Json json = valid_json();
    json["rows"][1].erase("delta_R_max");
    folder.file("results.json", json.dump());
    CHECK_THROWS_WITH(read_results(folder.path(), rows_of_trees),
                      Contains("row 2: ") && Contains("delta_R_max"));
}

}  // namespace controlspace::read_results_test
