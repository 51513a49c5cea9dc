// SPDX-License-Identifier: Apache-2.0
// The storage of leaf_gradients.h in a kd-tree and an octree: inserted, graded, adapted, packed,
// saved, measured.
#include <controlspace/sources/sampled_surfaces.h>
#include <controlspace/space/control_space_file.h>
#include <controlspace/study/run.h>

#include <cstdio>

#include "check.h"
#include "leaf_gradients.h"

namespace {

const std::vector<CatalogueEntry> gradients{
    tree_row<KdNode, LeafGradients>("K_LG", "kd-tree, a metric and its gradient in each leaf"),
    tree_row<OctreeNode, LeafGradients>("K_oLG", "octree, the same")};
const SpaceOptions options{.domain = {Point(-1, -1, -1), Point(1, 1, 1)}};

std::vector<Metric> answers(const ControlSpace& space) {
    std::vector<Point> x;
    for (int i = 0; i < 2000; ++i) {
        x.emplace_back(0.00105 * i - 1.05, 0.8 - 0.0009 * i, 0.19 * (i % 11) - 0.95);
    }
    std::vector<Metric> metrics(x.size());
    space.sample(x, metrics);
    return metrics;
}

std::unique_ptr<ControlSpaceBuilder> graded(const CatalogueEntry& row,
                                            const std::vector<PointSource>& sources) {
    auto builder = row.make(options);
    builder->insert(sources);
    builder->grade({});
    return builder;
}

// Without a field to fit, leaves are constant.
void check_insertion(const CatalogueEntry& row, const CatalogueEntry& constant,
                     const std::vector<PointSource>& sources) {
    check(answers(*graded(row, sources)->build()) == answers(*graded(constant, sources)->build()),
          "inserted and graded, the field is that of constant leaves");
}

void check_later_sources(const CatalogueEntry& row, const std::vector<PointSource>& sources) {
    SpaceOptions later = options;
    later.takes_later_sources = true;
    const GradationOptions by_queue{.schedule = GradationSchedule::queue};
    const auto at_once = row.make(later);
    at_once->insert(sources);
    at_once->grade(by_queue);
    const auto in_turn = row.make(later);
    in_turn->insert(std::span(sources).first(sources.size() - 9));
    in_turn->grade(by_queue);
    in_turn->insert(std::span(sources).last(9));
    in_turn->grade(by_queue);
    check(answers(*at_once->build()) == answers(*in_turn->build()),
          "with later sources the field is that of all at once");
}

void check_saving(const ControlSpace& space) {
    const char* file = "storage.ctrl";
    save_control_space(file, space);
    const auto loaded = load_control_space(file, gradients);
    std::remove(file);
    check(answers(*loaded) == answers(space), "loaded, it answers the same");
    check(loaded->footprint().bytes_total() <= space.footprint().bytes_total(),
          "in as much memory");
}

void check_adaptation(const CatalogueEntry& row, const CatalogueEntry& constant,
                      const std::vector<PointSource>& sources) {
    const AdaptationGoal goal{sources, nullptr, 1.25, 0.03};
    const auto builder = row.make(options);
    check(builder->adapt(goal).met, "it keeps to the target");
    const auto adapted = builder->build();
    const auto of_constant = constant.make(options);
    check(of_constant->adapt(goal).met, "so do constant leaves");
    check(2 * adapted->footprint().cells < of_constant->build()->footprint().cells,
          "with less than half as many leaves");
    check_saving(*adapted);

    const auto doubles = builder->build({.precision = Precision::doubles});
    check(answers(*doubles) == answers(*adapted), "its compact form answers the same");
    check_saving(*doubles);
    const auto floats = builder->build({.precision = Precision::floats});
    check(floats->footprint().bytes_total() < doubles->footprint().bytes_total(),
          "floats take less memory");
    check_saving(*floats);

    const PointSource later{Point(0.3, 0.2, -0.4), Metric::isotropic(0.01)};
    builder->insert(later);
    const auto finer = builder->build();
    check(sample_at(*finer, later.position).xx < 1.42 * 0.01, "a later source is met");
    const std::vector<Metric> before = answers(*adapted), after = answers(*finer);
    for (std::size_t i = 0; i < before.size(); ++i) {
        check(after[i].xx <= before[i].xx * (1 + 1e-12), "and nothing gets longer");
    }
}

// The study runs the rows beside those of the catalogue.
void check_study() {
    std::vector<CatalogueEntry> all(tree_catalogue().begin(), tree_catalogue().end());
    all.insert(all.end(), gradients.begin(), gradients.end());
    Study study = parse_study(R"(
        sources = "sphere"
        h = 0.2
        access_points = 100
        access_repeats = 1
        creation_repeats = 1
        probe_grid = 9
        fine_probe_grid = 9
        target_delta = 0.03
        structures = ["K_oL", "K_LG", "K_oLG"]
    )",
                              "storage.toml");
    const std::vector<Row> results =
        PreparedStudy(study, StudyRows{all, case_parameters(), measures()}).run();
    check(results.size() == 3, "three structures are three rows");
    for (const Row& row : results) check(row.is_measured(), row.error.c_str());
    check(results[2].number("cells") < results[0].number("cells"), "fewer leaves than K_oL");
}

}  // namespace

int main() {
    const std::vector<PointSource> sources = sample_sphere({.h = 0.1, .rho = 1});
    const std::span<const CatalogueEntry> trees = tree_catalogue();
    for (std::size_t i = 0; i < gradients.size(); ++i) {
        const CatalogueEntry& constant = *find_entry(trees, i == 0 ? "K_L" : "K_oL");
        check_insertion(gradients[i], constant, sources);
        check_later_sources(gradients[i], sources);
        check_adaptation(gradients[i], constant, sources);
    }
    check_study();
    return failures;
}
