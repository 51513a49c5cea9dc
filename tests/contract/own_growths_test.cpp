// SPDX-License-Identifier: Apache-2.0
// Sources with gradation ratios of their own, in all structures.
#include <algorithm>
#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/space/control_space_file.h"
#include "editable_space.h"
#include "scratch_directory.h"

namespace controlspace::own_growths_test {
namespace {

constexpr double g = 1.25;

bool adapts(const CatalogueEntry& structure) {
    return does_not_round(structure) && !structure.has<VoxelSize>();
}

double largest_nonconformity(const ControlSpace& space, const Work& work) {
    const std::vector<Point> x = random_points(work.domain, 3000, 41);
    std::vector<Metric> exact(x.size());
    brute_force_reference(work.sources, g, largest_metric(work.domain))->sample(x, exact);
    const std::vector<Metric> own = answers(space, x);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        largest = std::max(largest, nonconformity(own[i], exact[i]));
    }
    return largest;
}

}  // namespace

STRUCTURE_CASE(adapts,
               "adapted to sources with ratios of their own: within the target of brute force",
               "[long]") {
    constexpr double target = 0.2;
    const Work work = with_own_growths(GENERATE(isotropic_sphere(), oblong_box()));
    CAPTURE(work.name);
    const auto space = editable(structure.make(work.options()));
    const AdaptationReport report = space->adapt(
        {.sources = work.sources, .continuous = nullptr, .ratio = g, .target = target});
    CHECK(report.met);
    CHECK(largest_nonconformity(*space, work) <= target);
    // Another ratio would be seen.
    Work alike = work;
    for (PointSource& source : alike.sources) source.growth = 0;
    CHECK(largest_nonconformity(*space, alike) > 2 * target);
}

STRUCTURE_CASE(every_structure,
               "a source that is coarser, but less steep, counts away from its place") {
    Work work{"two", {}};
    work.sources.push_back({Point(0.1, 0.1, 0.1), Metric::isotropic(0.1), 2});
    work.sources.push_back({Point(0.12, 0.1, 0.1), Metric::isotropic(0.15), 1});
    const auto space = work.graded(structure);
    const Metric far = sample_at(*space, Point(-0.9, -0.9, -0.9));
    CHECK(far.xx == Approx(0.15).epsilon(1e-3));
}

STRUCTURE_CASE(every_structure, "a ratio that is none is refused, with the index of its source") {
    const Work work = oblong_box();
    const auto space = work.inserted(structure);
    const std::vector<Point> x = random_points(work.domain, 200, 1);
    const std::vector<Metric> before = answers(*space, x);
    for (const double bad : {0.9, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
        std::vector<PointSource> sources(work.sources.begin(), work.sources.begin() + 3);
        sources[2].growth = bad;
        CAPTURE(bad);
        CHECK_THROWS_WITH(space->insert(sources),
                          Catch::Contains("source 2 has the gradation ratio"));
        if (bad == 1e7) continue;  // of no source, but of a gradation
        CHECK_THROWS_AS(space->grade({.ratio = bad}), InputError);
    }
    CHECK(answers(*space, x) == before);
}

TEST_CASE("gradation from node to node is refused for ratios of their own") {
    const Work work = with_own_growths(isotropic_sphere());
    const CatalogueEntry structure = structures_that(does_not_round).front();
    const auto space = work.inserted(structure);
    CHECK_THROWS_WITH(space->grade({.law = GradationLaw::mean_length}),
                      Catch::Contains("ratios of their own"));
    CHECK_THROWS_WITH(space->grade({.schedule = GradationSchedule::queue}),
                      Catch::Contains("ratios of their own"));
    space->adapt({.sources = work.sources, .continuous = nullptr, .ratio = g, .target = 1});
    CHECK_THROWS_WITH(space->insert(work.sources),
                      Catch::Contains("source 1 has a gradation ratio"));
    space->insert(work.sources.front());
    CHECK_THROWS_WITH(space->grade({}), Catch::Contains("not known any more"));

    // A file without the sources says that there were some.
    const ScratchDirectory scratch("own-growths");
    const auto graded = work.graded(structure);
    save_control_space(scratch / "f.ctrl", graded->built());
    const auto loaded = load_editable(scratch / "f.ctrl", structures());
    CHECK_THROWS_WITH(loaded->grade({}), Catch::Contains("not known any more"));
}

}  // namespace controlspace::own_growths_test
