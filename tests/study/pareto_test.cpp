// SPDX-License-Identifier: Apache-2.0
#include "study/pareto.h"

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "study/sample_rows.h"

namespace controlspace::pareto_test {
namespace {

Row row_at(const char* structure, std::size_t bytes, double ns, double worst, double mean) {
    Row row = sample_row({.structure = structure});
    row.values["bytes_total"] = static_cast<std::int64_t>(bytes);
    for (const char* end : {"", "_q1", "_q3"}) {
        row.values[std::string("t_access_ns_random") + end] = ns;
    }
    row.values["delta_R_fine_max"] = worst;
    row.values["delta_R_fine_mean"] = mean;
    return row;
}

std::vector<bool> front(const ParetoPlot& plot) {
    std::vector<bool> marks;
    for (const ParetoPoint& p : plot.points) marks.push_back(p.on_front);
    return marks;
}

}  // namespace

TEST_CASE("a front holds what nothing else is at most as large as in both") {
    std::vector<Row> rows{row_at("a", 10, 9, 0.5, 0.1), row_at("b", 20, 1, 0.5, 0.2),
                          row_at("c", 30, 5, 0.1, 0.3), row_at("d", 40, 7, 0.1, 0.3),
                          row_at("a", 10, 9, 0.5, 0.1)};
    const auto plots = pareto_plots(rows);
    REQUIRE(plots.size() == 4);
    CHECK(plots[0].cost == "bytes_total");
    CHECK(front(plots[0]) == std::vector{true, false, true, false, true});
    CHECK(plots[1].error == "delta_R_fine_mean");
    CHECK(front(plots[1]) == std::vector{true, false, false, false, true});
    CHECK(plots[2].cost == "t_access_ns_random");
    CHECK(front(plots[2]) == std::vector{false, true, true, false, false});
    CHECK(plots[3].points[1].cost == 1);
    CHECK(plots[3].points[1].error == 0.2);

    const auto tables = pareto_tables(rows);
    REQUIRE(tables.size() == 1);
    REQUIRE(tables[0].rows.size() == 4);
    CHECK(tables[0].rows[0].front() == "c");
    CHECK(tables[0].rows[0].back() == "memory, access");
    CHECK(tables[0].rows[1].back() == "memory");
    CHECK(tables[0].rows[2].back() == "access");
}

TEST_CASE("a row that a limit stopped is on no front and keeps no other row from one") {
    std::vector<Row> rows{row_at("a", 10, 1, 0.1, 0.1), row_at("b", 20, 2, 0.2, 0.2)};
    CHECK(front(pareto_plots(rows)[0]) == std::vector{true, false});
    rows[0].values["stopped"] = "stopped at 60 s, 9 leaves, δ 0.1 reached";
    for (const ParetoPlot& plot : pareto_plots(rows)) {
        CHECK(front(plot) == std::vector{false, true});
    }
}

TEST_CASE("rows are weighed against those of the same work, at any tau and target") {
    std::vector<Row> rows(6, row_at("K_oL", 10, 9, 0.5, 0.1));
    rows[1].setting.tau = 0.5;
    rows[2].setting.target_delta = 0.1;
    rows[3].setting.sources.rho = 0.2;
    rows[4].setting.g_r = 1.5;
    rows[5].values["delta_R_fine_max"] = std::numeric_limits<double>::infinity();
    rows.push_back(failed_row());
    const auto plots = pareto_plots(rows);
    REQUIRE(plots.size() == 4);  // densities and ratios that stand alone have none
    for (const ParetoPlot& plot : plots) CHECK(plot.points.size() == 3);

    const auto json = nlohmann::json::parse(pareto_json(rows));
    REQUIRE(json.size() == 4);
    CHECK(json[0]["work"] == plots[0].work);
    CHECK(json[0]["cost"] == "bytes_total");
    CHECK(json[3]["cost"] == "t_access_ns_random");
    CHECK(json[3]["error"] == "delta_R_fine_mean");
    CHECK(json[3]["points"][1]["label"] == "K_oL, tau 0.5");
    CHECK(json[3]["points"][2]["label"] == "K_oL, δ <= 0.1");
    CHECK(json[3]["points"][1]["cost"] == 9);
    CHECK(json[3]["points"][1]["front"] == true);
}

TEST_CASE("a row leaves the front of access only for one that is faster beyond the quartiles") {
    std::vector<Row> rows{row_at("a", 10, 9, 0.5, 0.1), row_at("b", 20, 8, 0.1, 0.1)};
    CHECK(front(pareto_plots(rows)[2]) == std::vector{false, true});
    rows[1].values["t_access_ns_random_q3"] = 9.5;
    CHECK(front(pareto_plots(rows)[2]) == std::vector{true, true});
}

}  // namespace controlspace::pareto_test
