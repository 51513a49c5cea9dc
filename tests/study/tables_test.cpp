// SPDX-License-Identifier: Apache-2.0
#include "study/tables.h"

#include <catch2/catch.hpp>

#include "study/sample_rows.h"

namespace controlspace::tables_test {

using Catch::Matchers::Contains;

namespace {

/// The cell of `structure` under `column`.
std::string cell(const TextTable& table, const std::string& structure, const std::string& column) {
    for (const auto& row : table.rows) {
        if (row[0] != structure) continue;
        for (std::size_t j = 0; j < table.columns.size(); ++j) {
            if (table.columns[j].header == column) return row[j];
        }
    }
    return "no such cell";
}

}  // namespace

TEST_CASE("every row is in one table of measures that names its mode") {
    Case defaults = published_case();
    defaults.law = GradationLaw::cone;
    defaults.schedule = GradationSchedule::sources;
    defaults.reference = &exact_reference_kind();
    Case grid = defaults;
    grid.structure = "uniform-nearest";
    grid.split.reset();
    std::vector<Row> rows{sample_row(defaults), sample_row(published_case()), sample_row(grid)};
    rows[2].values.clear();
    rows[2].error = "no memory";
    const auto tables = measure_tables(rows, tree_rows());
    REQUIRE(tables.size() == 2);
    CHECK_THAT(tables[0].title,
               Contains("exact reference, cone law, sources") && Contains("tau 1"));
    CHECK_THAT(tables[1].title, Contains("published-sphere reference, mean-length law, passes"));
    CHECK(tables[0].rows.size() == 2);
    CHECK(cell(tables[0], "K_L s_L", "MB") == "1.23");
    CHECK(cell(tables[0], "K_L s_L", "cells") == "103");
    CHECK(cell(tables[0], "K_L s_L", "creation s") == "1.750");
    CHECK(cell(tables[0], "K_L s_L", "random ns") == "51.0");
    CHECK(cell(tables[0], "K_L s_L", "near ns") == "61.0");
    CHECK(cell(tables[0], "K_L s_L", "δ_R p99") == "0.4000");
    CHECK(cell(tables[0], "K_L s_L", "fine max") == "2.7800");
    CHECK(cell(tables[0], "K_L s_L", "fine coarser") == "7.00 %");
    CHECK(cell(tables[0], "K_L s_L", "within") == "1.400x");
    CHECK(cell(tables[0], "K_L s_L", "fine finer") == "9.00 %");
    CHECK(cell(tables[0], "K_L s_L", "G_det") == "1.310");
    CHECK(cell(tables[0], "K_L s_L", "G_dir") == "1.620");
    CHECK(cell(tables[0], "K_L s_L", "G left") == "1.2499");
    CHECK(cell(tables[0], "uniform-nearest", "MB") == "–");
    CHECK(cell(tables[0], "uniform-nearest", "remark") == "failed: no memory");
    for (const auto& table : tables) {
        for (const auto& row : table.rows) CHECK(row.size() == table.columns.size());
    }
}

}  // namespace controlspace::tables_test
