// SPDX-License-Identifier: Apache-2.0
// A measure of one's own: control nodes for each cell. Results, CSV and tables follow from its row.
#include <controlspace/baselines/catalogue.h>
#include <controlspace/study/run.h>

#include <cmath>

#include "brute_force.h"
#include "check.h"

int main() {
    std::vector<Measure> rows(measures().begin(), measures().end());
    Measure nodes;
    nodes.key = "nodes_per_cell";
    nodes.value = [](const Finished& finished) -> MeasuredValue {
        const auto cells = static_cast<double>(finished.footprint.cells);
        if (cells == 0) return {};
        return static_cast<double>(finished.footprint.control_nodes) / cells;
    };
    nodes.column = {"nodes/cell", "{:.2f}"};
    rows.push_back(nodes);

    std::vector<CatalogueEntry> all(structures().begin(), structures().end());
    all.push_back(brute_force_row());
    Study study = parse_study(R"(
        sources = "sphere"
        h = 0.2
        access_points = 100
        access_repeats = 1
        creation_repeats = 1
        probe_grid = 5
        fine_probe_grid = 3
        structures = ["K_oL", "K_oV", "brute-force"]
    )",
                              "measure.toml");
    const std::vector<Row> results =
        PreparedStudy(study, StudyRows{all, case_parameters(), rows}).run();

    check(results.size() == 3, "three structures are three rows");
    for (const Row& row : results) check(row.is_measured(), row.error.c_str());
    check(results[0].number("nodes_per_cell") == 1, "leaves hold a node each");
    check(results[1].number("nodes_per_cell") > 1, "vertices are more than leaves");
    check(std::isnan(results[2].number("nodes_per_cell")), "what has no cells has no such measure");
    return failures;
}
