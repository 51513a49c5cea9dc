// SPDX-License-Identifier: Apache-2.0
// A setting of one's own: `stretch`, a factor of the maximum leaf edge. The study file, the cases,
// labels and results follow from its row.
#include <controlspace/baselines/catalogue.h>
#include <controlspace/study/run.h>

#include "check.h"

using namespace controlspace;

int main() {
    std::vector<CaseParameter> parameters(case_parameters().begin(), case_parameters().end());
    CaseParameter stretch;
    stretch.key = "stretch";
    stretch.help = "factor of the maximum leaf edge";
    stretch.access = other_number("stretch", positive);
    stretch.role = Role::structure;
    stretch.defaults = {1.0};
    stretch.fits = [](const CatalogueEntry& row, const Case&) { return row.has<SourceLeaves>(); };
    stretch.apply = [](const Case& c, SpaceOptions& options) {
        options.l_min *= c.other.at("stretch").number();
    };
    parameters.push_back(stretch);

    const Study study = parse_study(R"(
        sources = "sphere"
        h = 0.2
        access_points = 100
        access_repeats = 1
        creation_repeats = 1
        probe_grid = 5
        fine_probe_grid = 3
        [[runs]]
        structures = ["K_oL", "uniform-nearest"]
        stretch = [1, 0.25]
    )",
                                    "setting.toml", parameters);
    const std::vector<Row> results =
        PreparedStudy(study, StudyRows{structures(), parameters}).run();

    check(results.size() == 3, "it multiplies the tree, not the grid");
    for (const Row& row : results) check(row.is_measured(), row.error.c_str());
    check(results[1].number("cells") > 8 * results[0].number("cells"),
          "a quarter cuts more leaves");
    return failures;
}
