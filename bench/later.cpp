// SPDX-License-Identifier: Apache-2.0
// Sources that come later: inserting and grading 1 % more of them, against all at once. In CPU time
// of all threads together.
//
// Of the sphere's sources every hundredth is left out ("scattered"), or the 1 % nearest to the
// point (1, 0, 0) ("cap"); the others are inserted and graded before. A third set ("inside") is as
// many sources at random places, each half as large as the exact field there.
//
// Names: SET/rho_R/STRUCTURE. Counters: later_ms and all_at_once_ms, means over the iterations, and
// their quotient; later_sources; control nodes at the end. The time that is reported is later_ms.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/reference.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "measure/stopwatch.h"

using namespace controlspace;

namespace {

const Box domain{Point::Constant(-1), Point::Constant(1)};

/// Sources before, and after, gradation.
struct Work {
    std::vector<PointSource> early, late;
};

Work scattered(double rho) {
    Work work;
    const std::vector<PointSource> all = sample_sphere({.rho = rho});
    for (std::size_t i = 0; i < all.size(); ++i) {
        (i % 100 == 50 ? work.late : work.early).push_back(all[i]);
    }
    return work;
}

Work cap(double rho) {
    Work work{sample_sphere({.rho = rho}), {}};
    std::stable_sort(work.early.begin(), work.early.end(),
                     [](const auto& a, const auto& b) { return a.position.x() < b.position.x(); });
    const auto first = work.early.end() - static_cast<std::ptrdiff_t>(work.early.size() / 100);
    work.late.assign(first, work.early.end());
    work.early.erase(first, work.early.end());
    return work;
}

Work inside(double rho) {
    Work work{sample_sphere({.rho = rho}), {}};
    const std::vector<Point> places = random_points(domain, work.early.size() / 100, 1);
    std::vector<Metric> sizes(places.size());
    exact_reference(work.early, 1.25, Metric::isotropic(domain.half_diagonal()))
        ->sample(places, sizes);
    for (std::size_t i = 0; i < places.size(); ++i) {
        work.late.push_back({places[i], Metric::isotropic(0.5 * sizes[i].xx)});
    }
    return work;
}

std::unique_ptr<ControlSpaceBuilder> make(const CatalogueEntry& entry, const Work& work) {
    return entry.make({.domain = domain,
                       .finest_length = finest_length(work.early),
                       .takes_later_sources = true});
}

constexpr GradationOptions gradation{.schedule = GradationSchedule::queue};

void later(benchmark::State& state, const CatalogueEntry& entry, const Work& work) {
    double all_at_once = 0;
    double late = 0;
    for (auto _ : state) {
        Stopwatch time;
        auto space = make(entry, work);
        space->insert(work.early);
        space->insert(work.late);
        space->grade(gradation);
        all_at_once += time.processor_seconds();

        space = make(entry, work);
        space->insert(work.early);
        space->grade(gradation);
        time = {};
        space->insert(work.late);
        space->grade(gradation);
        const double seconds = time.processor_seconds();
        late += seconds;
        state.SetIterationTime(seconds);
        state.counters["nodes"] = static_cast<double>(space->build()->footprint().control_nodes);
    }
    state.counters["later_sources"] = static_cast<double>(work.late.size());
    state.counters["later_ms"] = 1e3 * late / static_cast<double>(state.iterations());
    state.counters["all_at_once_ms"] = 1e3 * all_at_once / static_cast<double>(state.iterations());
    state.counters["all_at_once_over_later"] = all_at_once / late;
}

struct Job {
    const char* name;
    Work (*make_work)(double rho);
    double rho;
    int repetitions;
};

}  // namespace

int main(int argc, char** argv) {
    for (const Job& job :
         {Job{"scattered/rho_1/", scattered, 1, 3}, Job{"cap/rho_1/", cap, 1, 3},
          Job{"inside/rho_1/", inside, 1, 3}, Job{"scattered/rho_0.2/", scattered, 0.2, 1},
          Job{"cap/rho_0.2/", cap, 0.2, 1}, Job{"inside/rho_0.2/", inside, 0.2, 1}}) {
        for (const CatalogueEntry& entry : structures()) {
            const auto run = [&entry, job](benchmark::State& state) {
                try {
                    later(state, entry, job.make_work(job.rho));
                } catch (const InputError& error) {  // grids of floats take none
                    state.SkipWithError(error.what());
                }
            };
            benchmark::RegisterBenchmark((job.name + entry.id).c_str(), run)
                ->UseManualTime()
                ->Iterations(job.repetitions)
                ->Unit(benchmark::kMillisecond);
        }
    }
    benchmark::AddCustomContext("times", "CPU time of all threads");
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
