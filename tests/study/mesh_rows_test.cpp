// SPDX-License-Identifier: Apache-2.0
#include "study/mesh_rows.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace controlspace::mesh_rows_test {

using Catch::Matchers::Contains;

namespace {

MeshRow row_of(const std::string& structure, double l_r, double delta_r) {
    MeshRow row;
    row.setting.structure = structure;
    row.setting.max_depth = 14;
    row.conformity.l_r = l_r;
    row.conformity.tets = 350000;
    row.conformity.edges = 400;
    row.conformity.histogram = {0, 0, 40, 0, 360};
    row.cost.seconds = 20;
    row.cost.processor_seconds = 10;
    row.cost.query_seconds = 0.5;
    row.delta_r = Accuracy{.max = delta_r, .mean = delta_r / 10};
    return row;
}

std::vector<MeshRow> sample_rows() {
    std::vector<MeshRow> rows{row_of("K_oL", 0.8025, 0), row_of("K_oL", 0.7512, 1.9),
                              row_of("K_oLB", 0.7634, 0.6), row_of("K_oV", 0.7957, 0.2)};
    rows.front().exact = true;
    rows.front().delta_r.reset();
    return rows;
}

}  // namespace

TEST_CASE("the table shows L_R beside that of the exact field's mesh") {
    const std::string text = mesh_tables(sample_rows());
    CHECK_THAT(text, Contains("0.7512") && Contains("0.7634") && Contains("0.7957"));
    CHECK_THAT(text, Contains("  -0.0513  ") && Contains("  -0.0068  "));
    CHECK_THAT(text, Contains("  5.00 %  "));
}

TEST_CASE("another mesher has no exact field's mesh beside it") {
    std::vector<MeshRow> rows = sample_rows();
    rows[2].mesher = Mesher::hxt;
    const std::string text = mesh_tables(rows);
    CHECK_THAT(text, Contains("Meshes: delaunay") && Contains("Meshes: hxt"));
    CHECK_THAT(text, !Contains("-0.0391"));  // K_oLB, by another mesher
}

TEST_CASE("a mesh that failed is a row with its reason") {
    std::vector<MeshRow> rows = sample_rows();
    rows[0].error = "no exact mesh";
    rows[1].error = "MMG failed";
    const std::string text = mesh_tables(rows);
    CHECK_THAT(text, Contains("failed: MMG failed"));
    CHECK_THAT(text, !Contains("-0.0068"));
    const auto json = nlohmann::json::parse(mesh_json({}, {}, {}, rows, true));
    CHECK(json["rows"][1]["error"] == "MMG failed");
    CHECK_FALSE(json["rows"][1].contains("L_R"));
}

TEST_CASE("meshes.json keeps rows and settings") {
    MeshSettings settings;
    settings.gmsh.factor = 0.8;
    const auto json = nlohmann::json::parse(mesh_json({}, {}, settings, sample_rows(), false));
    CHECK(json["complete"] == false);
    CHECK(json["settings"]["factor"] == "0.8");
    CHECK(json["settings"]["mesher"] == "auto");
    REQUIRE(json["rows"].size() == 4);
    CHECK(json["rows"][0]["field"] == "exact");
    CHECK_FALSE(json["rows"][0].contains("delta_R_max"));
    CHECK(json["rows"][3]["field"] == "K_oV");
    CHECK(json["rows"][3]["label"] == "K_oV");
    CHECK(json["rows"][3]["L_R_beside_exact"] == Approx(-0.0068));
    CHECK(json["rows"][3]["L_R"] == 0.7957);
    CHECK(json["rows"][3]["histogram"].size() == json["length_bounds"].size() + 1);
}

}  // namespace controlspace::mesh_rows_test
