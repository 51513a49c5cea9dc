// SPDX-License-Identifier: Apache-2.0
// One answer whatever the number of threads, to the bit.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <catch2/catch.hpp>

#include "contract/structure_case.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/space/control_space_file.h"
#include "editable_space.h"
#include "scratch_directory.h"

namespace controlspace::threads_test {
namespace {

struct Answers {
    InsertionReport insertion;
    GradationReport gradation;
    std::vector<Metric> nodes, places;
    double at_sources = 0, anywhere = 0;  ///< departures from the sources, and from a constant
    std::string saved;
};

Answers answers(const CatalogueEntry& structure, const Work& work, const GradationOptions& options,
                int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    Answers a;
    tbb::task_arena(threads).execute([&] {
        const auto space = editable(structure.make(work.options()));
        a.insertion = space->insert(work.sources);
        a.gradation = space->grade(options);
        a.nodes = space->control_nodes(Neighbourhood::faces).metrics;
        a.places.resize(3000);
        const std::vector<Point> x = random_points(work.domain, a.places.size(), 3);
        space->sample(x, a.places);
        a.at_sources = source_accuracy(*space, work.sources);
        a.anywhere = accuracy(*space, {x, std::vector(x.size(), Metric::isotropic(0.1))}).mean;
        const ScratchDirectory scratch("threads");
        save_control_space(scratch / "field.ctrl", *space);
        a.saved = file_text(scratch / "field.ctrl");
    });
    return a;
}

}  // namespace

STRUCTURE_CASE(does_not_round,
               "any number of threads makes the same field, to the bit, in memory and in a file",
               "[threads][long]") {
    const Work work = GENERATE(isotropic_sphere(), anisotropic_sphere());
    const GradationOptions options =
        GENERATE(GradationOptions{}, GradationOptions{.law = GradationLaw::mean_length},
                 GradationOptions{.schedule = GradationSchedule::passes},
                 GradationOptions{.neighbourhood = Neighbourhood::all});
    CAPTURE(work.name);
    const Answers one = answers(structure, work, options, 1);
    for (const int threads : {2, 3, 7}) {
        const Answers many = answers(structure, work, options, threads);
        CHECK(many.insertion.inserted == one.insertion.inserted);
        CHECK(many.gradation.operations == one.gradation.operations);
        CHECK(many.gradation.largest_ratio_left == one.gradation.largest_ratio_left);
        CHECK(many.nodes == one.nodes);
        CHECK(many.places == one.places);
        CHECK(many.at_sources == one.at_sources);
        CHECK(many.anywhere == one.anywhere);
        CHECK((many.saved == one.saved));
    }
}

}  // namespace controlspace::threads_test
