// Adaptation to a target accuracy beside ordinary creation, on the paper's sphere (rho 1).
//
// Names: ordinary/STRUCTURE and adapted/STRUCTURE/TARGET. The time is the wall clock's, with all
// threads; counters give the CPU time of all threads together (cpu_ms), leaves and megabytes, and
// of what was adapted the δ it says it reached, and the largest δ to the exact field at 101^3
// places (delta_101). Times compare where repetitions are interleaved:
//     bench_adaptation --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <functional>
#include <memory>
#include <vector>

#include "controlspace/measure/accuracy.h"
#include "controlspace/measure/reference.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"

using namespace controlspace;

namespace {

constexpr double ratio = 1.25;
const Box domain{Point::Constant(-1), Point::Constant(1)};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Reports what `fill` takes, on a structure that was made for it.
std::unique_ptr<ControlSpace> timed(benchmark::State& state, const CatalogueEntry& entry,
                                    const std::vector<PointSource>& sources,
                                    const std::function<void(ControlSpaceBuilder&)>& fill) {
    using Clock = std::chrono::steady_clock;
    std::unique_ptr<ControlSpace> space;
    double cpu = 0;
    for (auto _ : state) {
        const double cpu_before = cpu_seconds();
        const auto start = Clock::now();
        const auto builder =
            entry.make({.domain = domain, .finest_length = finest_length(sources)});
        fill(*builder);
        space = builder->build();
        state.SetIterationTime(std::chrono::duration<double>(Clock::now() - start).count());
        cpu += cpu_seconds() - cpu_before;
    }
    state.counters["cpu_ms"] = 1e3 * cpu / static_cast<double>(state.iterations());
    const Footprint footprint = space->footprint();
    state.counters["leaves"] = static_cast<double>(footprint.cells);
    state.counters["megabytes"] = 1e-6 * static_cast<double>(footprint.bytes_total());
    return space;
}

template <class Run>
void enter(const std::string& name, Run&& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<PointSource> sources = sample_sphere({.rho = 1});
    const auto field = exact_reference(sources, ratio, largest_metric(domain));
    const Probes probes = make_probes(*field, cell_centres(domain, 101));
    for (const auto& entries : {tree_catalogue(), anchored_catalogue()}) {
        for (const CatalogueEntry& entry : entries) {
            enter("ordinary/" + entry.id, [&](benchmark::State& state) {
                timed(state, entry, sources, [&](ControlSpaceBuilder& space) {
                    space.insert(sources);
                    space.grade({.ratio = ratio});
                });
            });
            for (const double target : {0.1, 0.02}) {
                enter(fmt::format("adapted/{}/{}", entry.id, target),
                      [&, target](benchmark::State& state) {
                          AdaptationReport report;
                          const auto space =
                              timed(state, entry, sources, [&](ControlSpaceBuilder& s) {
                                  report = s.adapt({sources, nullptr, ratio, target});
                              });
                          state.counters["reached"] = report.reached;
                          state.counters["delta_101"] = accuracy(*space, probes).max;
                      });
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
