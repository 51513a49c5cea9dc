// SPDX-License-Identifier: Apache-2.0
// Lengths fitted to a field in place of its own values: the same promise with fewer nodes.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/fields/analytic_field.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_space_file.h"
#include "editable_space.h"
#include "scratch_directory.h"

namespace controlspace::fitted_values_test {

using Catch::Matchers::Contains;

namespace {

bool fits_values(const CatalogueEntry& structure) { return structure.has<FittedValues>(); }
// Grids of floats take no later sources.
bool fits_later_values(const CatalogueEntry& structure) {
    return fits_values(structure) && structure.has<CompactForm>();
}
bool fits_given_voxels(const CatalogueEntry& structure) {
    return fits_values(structure) && structure.has<VoxelSize>();
}
bool fits_no_values(const CatalogueEntry& structure) { return !structure.has<FittedValues>(); }

AdaptationGoal goal(std::span<const PointSource> sources, double target, NodeValues values) {
    return {.sources = sources, .continuous = nullptr, .target = target, .values = values};
}

}  // namespace

STRUCTURE_CASE(fits_values, "fitted values keep the target by fewer nodes, in every precision") {
    const Work work = GENERATE(isotropic_sphere(), oblong_box(), flat_box());
    const double target = GENERATE(0.1, 0.05);
    const auto chosen = GENERATE(Precision::doubles, Precision::floats, Precision::log16);
    // Other systems have a precision of their own.
    const bool has_choice = structure.has<CompactForm>();
    const Precision precision = has_choice ? chosen : Precision::doubles;
    CAPTURE(work.name, target, static_cast<int>(precision));
    std::size_t cells[2];
    for (const NodeValues values : {NodeValues::field, NodeValues::fitted}) {
        const auto space = editable(structure.make(work.options()));
        AdaptationGoal wanted = goal(work.sources, target, values);
        wanted.precision = precision;
        const AdaptationReport report = space->adapt(wanted);
        CHECK(report.met);
        CHECK(report.is_bound);
        CHECK(report.reached <= target);
        const auto compact = has_choice ? space->compact(precision) : nullptr;
        const ControlSpace& built = has_choice ? *compact : space->built();
        cells[static_cast<int>(values)] = built.footprint().cells;
        std::vector<Point> x = random_points(work.domain, 5'000, 3);
        for (const PointSource& s : work.sources) x.push_back(s.position);
        double worst = 0;
        for (const Point& p : x) {
            worst = std::max(
                worst, nonconformity(built.metric_at(p), Metric::isotropic(exact_length(work, p))));
        }
        CHECK(worst <= report.reached * (1 + 1e-9));
    }
    // A convex function is missed on one side alone by its own values: by twice as much, so that
    // voxels may have edges 1.4 times as long. Leaves have edges of halves.
    const double dimensions = work.name == "flat" ? 2 : 3;
    const double share = structure.has<VoxelSize>() ? std::pow(0.8, dimensions) : 0.75;
    CHECK(static_cast<double>(cells[1]) <= share * static_cast<double>(cells[0]));
}

STRUCTURE_CASE(fits_given_voxels, "voxels that were given keep a target by fitted values alone") {
    const Work work = isotropic_sphere();
    SpaceOptions options = work.options();
    options.voxel = 0.1;
    const auto adapted = [&](NodeValues values) {
        return editable(structure.make(options))->adapt(goal(work.sources, 0.025, values));
    };
    CHECK_FALSE(adapted(NodeValues::field).met);
    const AdaptationReport report = adapted(NodeValues::fitted);
    CHECK(report.met);
    CHECK(report.is_bound);
}

STRUCTURE_CASE(fits_values, "fitted values are the same bits on any number of threads",
               "[threads]") {
    const Work work = oblong_box();
    const auto nodes = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        std::vector<Metric> metrics;
        tbb::task_arena(threads).execute([&] {
            const auto space = editable(structure.make(work.options()));
            space->adapt(goal(work.sources, 0.1, NodeValues::fitted));
            metrics = space->control_nodes(Neighbourhood::faces).metrics;
        });
        return metrics;
    };
    CHECK(nodes(1) == nodes(3));
}

STRUCTURE_CASE(fits_later_values,
               "sources that come later are fitted as all at once, after a file too") {
    const Work work = isotropic_sphere();
    const std::span<const PointSource> all = work.sources;
    SpaceOptions options = work.options();
    options.takes_later_sources = true;
    const auto space = editable(structure.make(options));
    space->adapt(goal(all.first(all.size() / 2), 0.2, NodeValues::fitted));
    space->insert(all.subspan(all.size() / 2));
    const ScratchDirectory scratch;
    save_control_space(scratch / "fitted.ctrl", *space);
    const auto loaded = load_editable(scratch / "fitted.ctrl", structures());
    options.takes_later_sources = false;
    const auto at_once = editable(structure.make(options));
    at_once->adapt(goal(all, 0.2, NodeValues::fitted));
    const std::vector<Point> x = random_points(work.domain, 1000, 4);
    for (EditableSpace* later : {space.get(), loaded.get()}) {
        later->grade({});
        CHECK(answers(*later, x) == answers(*at_once, x));
    }
}

STRUCTURE_CASE(fits_values, "tensors and continuous fields are fitted by none") {
    const auto space = editable(structure.make(anisotropic_sphere().options()));
    const std::vector<PointSource> tensors = anisotropic_sphere().sources;
    CHECK_THROWS_WITH(space->adapt(goal(tensors, 0.1, NodeValues::fitted)),
                      Contains("lengths alone"));
    const std::vector<PointSource> lengths = isotropic_sphere().sources;
    AdaptationGoal mixed = goal(lengths, 0.1, NodeValues::fitted);
    mixed.continuous =
        function_field([](const Point&) { return Metric::isotropic(0.3); }, 0.3).field;
    CHECK_THROWS_WITH(space->adapt(mixed), Contains("lengths alone"));
}

STRUCTURE_CASE(fits_no_values, "structures that fit no values say so") {
    const std::vector<PointSource> sources = isotropic_sphere().sources;
    const auto space = structure.make(isotropic_sphere().options());
    CHECK_THROWS_WITH(space->adapt(goal(sources, 0.1, NodeValues::fitted)),
                      Contains("give values `field`"));
}

}  // namespace controlspace::fitted_values_test
