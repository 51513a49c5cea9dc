// Creation: insertion and gradation of every tree of the catalogue on the paper's sphere.
//
// Names: creation/STRUCTURE/WORK/one-thread and creation/STRUCTURE/WORK/all-threads. The time is
// that of both, by the wall clock; counters give the two apart (insertion_ms, gradation_ms), the
// number of leaves, and nanoseconds for a leaf.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"

using namespace controlspace;

namespace {

struct Work {
    const char* name;
    double tau;
    SphereSampling sampling;
};
const Work works[] = {{"rho:1/tau:1", 1, {}},
                      {"rho:1/tau:0.2", 0.2, {}},
                      {"rho:0.2/tau:1", 1, {.rho = 0.2}},
                      {"rho:0.2/tau:0.2", 0.2, {.rho = 0.2}},
                      {"layered/tau:1", 1, {.s_a = 4, .s_n = 0.25}}};

const std::vector<PointSource>& sources_of(const Work& work) {
    static std::map<std::string, std::vector<PointSource>> made;
    std::vector<PointSource>& sources = made[work.name];
    if (sources.empty()) sources = sample_sphere(work.sampling);
    return sources;
}

void create(benchmark::State& state, const CatalogueEntry& entry, const Work& work, int threads) {
    using Clock = std::chrono::steady_clock;
    using Seconds = std::chrono::duration<double>;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    const std::vector<PointSource>& sources = sources_of(work);
    const Box domain{Point::Constant(-1), Point::Constant(1)};
    const SpaceOptions options{
        .domain = domain, .l_min = work.tau, .finest_length = finest_length(sources)};
    Seconds insertion{0};
    Seconds gradation{0};
    double leaves = 0;
    for (auto _ : state) {
        const auto start = Clock::now();
        auto space = entry.make(options);
        space->insert(sources);
        const auto inserted = Clock::now();
        space->grade({.ratio = options.ratio});
        const auto graded = Clock::now();
        state.SetIterationTime(Seconds(graded - start).count());
        insertion += inserted - start;
        gradation += graded - inserted;
        leaves = static_cast<double>(space->build()->footprint().cells);
    }
    const auto times = static_cast<double>(state.iterations());
    state.counters["insertion_ms"] = 1e3 * insertion.count() / times;
    state.counters["gradation_ms"] = 1e3 * gradation.count() / times;
    state.counters["leaves"] = leaves;
    state.counters["ns_per_leaf"] = 1e9 * (insertion + gradation).count() / times / leaves;
}

}  // namespace

int main(int argc, char** argv) {
    const std::pair<const char*, int> threads[] = {
        {"/one-thread", 1}, {"/all-threads", tbb::info::default_concurrency()}};
    for (const CatalogueEntry& entry : tree_catalogue()) {
        for (const Work& work : works) {
            for (const auto& [name, number] : threads) {
                const auto run = [&entry, &work, n = number](benchmark::State& state) {
                    create(state, entry, work, n);
                };
                benchmark::RegisterBenchmark(
                    ("creation/" + entry.id + "/" + work.name + name).c_str(), run)
                    ->UseManualTime()
                    ->Unit(benchmark::kMillisecond);
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
