// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/results.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "controlspace/error.h"
#include "scratch_directory.h"
#include "study/results_json.h"
#include "study/sample_rows.h"

namespace controlspace::results_test {

using Catch::Matchers::Contains;
using Json = nlohmann::ordered_json;

namespace {

const StudyRows rows_of_trees = tree_rows();

std::vector<std::string> keys(const Json& json) {
    std::vector<std::string> result;
    for (const auto& [key, value] : json.items()) result.push_back(key);
    return result;
}

/// Fields of the first record of a CSV text, which is taken away from it.
std::vector<std::string> take_record(std::string_view& csv) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    while (!csv.empty()) {
        const char c = csv.front();
        csv.remove_prefix(1);
        if (c == '"' && quoted && !csv.empty() && csv.front() == '"') {
            fields.back() += '"';
            csv.remove_prefix(1);
        } else if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            fields.emplace_back();
        } else if (c == '\n' && !quoted) {
            break;
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

}  // namespace

TEST_CASE("a row has the same fields, measured or not") {
    const std::vector<std::string> expected =
        keys(to_json(sample_row(published_case()), rows_of_trees));
    CHECK(keys(to_json(failed_row(), rows_of_trees)) == expected);
    CHECK(keys(to_json(Row{}, rows_of_trees)) == expected);
}

TEST_CASE("each field of a row has its own measure") {
    const Json json = to_json(sample_row(published_case()), rows_of_trees);
    CHECK(json["structure"] == "K_L");
    CHECK(json["split"] == "s_L");
    CHECK(json["rho"] == 1);
    CHECK(json["max_depth"] == 42);
    CHECK(json["law"] == "mean-length");
    CHECK(json["schedule"] == "passes");
    CHECK(json["reference"] == "published-sphere");
    CHECK(json["sources"] == 36186);
    CHECK(json["sources_inserted"] == 101);
    CHECK(json["tree_nodes"] == 102);
    CHECK(json["cells"] == 103);
    CHECK(json["control_nodes"] == 104);
    CHECK(json["depth"] == 21);
    CHECK(json["bytes_total"] == 1'230'000);
    CHECK(json["t_insert_s"] == 1.5);
    CHECK(json["t_insert_s_samples"] == std::vector<double>{1.5, 1.4, 1.9});
    CHECK(json["t_insert_s_q1"] == 1.45);
    CHECK(json["t_gradation_s"] == 0.25);
    CHECK(json["t_creation_s"] == 1.75);
    CHECK(json["access_batch"] == 3);
    CHECK(json["t_access_ns_random"] == 51);
    CHECK(json["t_access_ns_random_samples"] == std::vector<double>{52, 50, 51});
    CHECK(json["t_access_ns_grid"] == 11);
    CHECK(json["t_access_ns_single"] == 71);
    CHECK(json["t_access_ns_near"] == 61);
    CHECK(json["t_access_ns_walk_q1"] == 30.5);
    CHECK(json["t_access_ns_metric_random"] == 81);
    CHECK(json["t_access_ns_metric_single_samples"] == std::vector<double>{92, 90, 91});
    CHECK(json["answers"] == "lengths");
    CHECK(json["delta_S_max"] == 0.19);
    CHECK(json["delta_R_max"] == 1.78);
    CHECK(json["delta_R_p95"] == 0.3);
    CHECK(json["delta_R_fine_max"] == 2.78);
    CHECK(json["delta_metric_R_max"] == 9.5);
    CHECK(json["coarser_max"] == 1.3);
    CHECK(json["coarser_share"] == 0.06);
    CHECK(json["coarser_fine_max"] == 1.4);
    CHECK(json["coarser_fine_share"] == 0.07);
    CHECK(json["gradation_max_left"] == 1.2499);
    CHECK(json["gradation_operations"] == 105);
    CHECK(json["checksum"] == "ff00000000000001");
}

TEST_CASE("what does not apply or was not measured is null") {
    const Json json = to_json(failed_row(), rows_of_trees);
    for (const char* field : {"rho", "s_a", "s_n", "tree_nodes", "t_insert_s", "checksum"}) {
        CHECK(json[field].is_null());
    }
    CHECK(json["tau"] == 1);
    CHECK(json["error"] == "reason, \"as\" given");
}

TEST_CASE("CSV and JSON say the same") {
    const ScratchDirectory root;
    const std::vector<Row> rows{sample_row(published_case()), failed_row()};
    ResultsFolder folder(root / "a", {}, Study{}, rows_of_trees);
    for (const Row& row : rows) folder.add(row);
    const std::string text = file_text(root / "a" / "results.csv");
    std::string_view csv = text;
    const std::vector<std::string> fields = take_record(csv);
    // JSON alone has the files of sampled fields, and labels for the pages.
    std::vector<std::string> expected = fields;
    expected.insert(expected.end(), {"fields", "labels"});
    CHECK(keys(to_json(rows[0], rows_of_trees)) == expected);
    for (const Row& row : rows) {
        const Json json = to_json(row, rows_of_trees);
        const auto record = take_record(csv);
        REQUIRE(record.size() == fields.size());
        for (std::size_t i = 0; i < record.size(); ++i) {
            const Json& value = json[fields[i]];
            if (value.is_array()) {
                std::istringstream samples(record[i]);
                std::vector<double> read;
                for (double sample = 0; samples >> sample;) read.push_back(sample);
                CHECK(read == value.get<std::vector<double>>());
            } else if (value.is_null()) {
                CHECK(record[i].empty());
            } else {
                CHECK(record[i] == (value.is_string() ? value.get<std::string>() : value.dump()));
            }
        }
    }
    CHECK(csv.empty());
}

TEST_CASE("results.json says who made it and what was requested") {
    const ScratchDirectory root;
    Provenance provenance = current_provenance();
    provenance.command_line = "controlspace \xff";  // no UTF-8
    ResultsFolder folder(root / "a", provenance, Study{}, rows_of_trees);
    folder.add(sample_row(published_case()));
    folder.finish(true);
    const Json json = Json::parse(file_text(root / "a" / "results.json"));
    CHECK(json["schema_version"] == 2);
    CHECK(json["complete"] == true);
    CHECK(json["rows"].size() == 1);
    CHECK(json["outcomes"].size() == 1);
    CHECK_THAT(json["outcomes"][0]["sentences"][0].get<std::string>(), Contains("1.25x"));
    CHECK_THAT(json["descriptions"]["structures"]["K_L"].get<std::string>(), Contains("kd-tree"));
    CHECK_THAT(json["descriptions"]["settings"]["tau"].get<std::string>(), Contains("l_min"));
    CHECK(json["settings"]["sources"] == "sphere");
    CHECK(json["settings"]["domain"] == Json::array());
    CHECK(json["settings"]["runs"][0]["structures"] == Json{"all"});
    CHECK(json["settings"]["runs"][0]["splits"] == Json{"s_L", "s_G", "s_M"});
    CHECK_FALSE(json["settings"]["runs"][0].contains("mmg_hgrad"));
    CHECK(json["version"].get<std::string>().find('.') != std::string::npos);
}

TEST_CASE("a folder of results is whole after each row, and is not written over") {
    const ScratchDirectory root;
    const auto path = root / "a" / "b";
    {
        ResultsFolder folder(path, {}, Study{}, rows_of_trees);
        const auto stored = [&] { return Json::parse(file_text(path / "results.json")); };
        CHECK(stored()["rows"].empty());
        folder.add(sample_row(published_case()));
        CHECK(stored()["rows"].size() == 1);
        folder.add(failed_row());
        CHECK(stored()["rows"][1]["error"] == failed_row().error);
        CHECK(stored()["complete"] == false);
        folder.finish(true);
        CHECK(stored()["rows"].size() == 2);
        CHECK(stored()["complete"] == true);
    }
    CHECK_THAT(file_text(path / "results.csv"), Contains("K_L,none,regular,1.0,"));
    CHECK(names_in(path) == std::vector<std::string>{"results.csv", "results.json"});
    const auto again = [&](const std::filesystem::path& folder) {
        ResultsFolder(folder, {}, Study{}, rows_of_trees);
    };
    CHECK_THROWS_WITH(again(path), Contains("contains results already"));
    CHECK_THROWS_AS(again(path / "results.csv"), InputError);
    CHECK_THROWS_AS(again(path / "results.csv" / "c"), InputError);
}

TEST_CASE("a row that cannot be written leaves the rows before it") {
    const ScratchDirectory root;
    GrowingFile file(root / "f", "head", "tail");
    CHECK(file_text(root / "f") == "headtail");
    file.append(" row", " t");
    CHECK(file_text(root / "f") == "head row t");
    std::filesystem::rename(root / "f", root / "g");
    CHECK_THROWS_WITH(file.append("lost", "lost"), Contains("cannot be written"));
    std::filesystem::rename(root / "g", root / "f");
    file.append("!", "");
    CHECK(file_text(root / "f") == "head row!");
}

TEST_CASE("results go to the requested folder, or to one named after study and time") {
    Study study;
    study.name = std::string("n");
    Provenance provenance;
    provenance.date = "2024-05-01T12:34:56Z";
    CHECK(results_path(study, provenance) == "results/n-20240501-123456");
    study.output += "here";
    CHECK(results_path(study, provenance) == "here");
}

}  // namespace controlspace::results_test
