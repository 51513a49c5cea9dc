// SPDX-License-Identifier: Apache-2.0
// Creation, insertion and gradation, of every tree of the catalogue on spheres. Names:
//   creation/STRUCTURE/WORK/one-thread and creation/STRUCTURE/WORK/all-threads
//   growth/STRUCTURE/SERIES/sources:N, on one thread; SERIES "finer": spacing and lengths of the
//   sources shrink together, so that the structure grows with them; "denser": spacing alone
// The time is that of both, by the wall clock; counters give the two apart (insertion_ms,
// gradation_ms), the number of sources and leaves, and nanoseconds for a leaf; of growth access
// too: ns_random, at random places, and ns_elements, where elements are.

#include <benchmark/benchmark.h>
#include <tbb/info.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/threads.h"
#include "controlspace/measure/access_time.h"
#include "measure/stopwatch.h"
#include "works.h"

using namespace controlspace;

namespace {

std::unique_ptr<ControlSpace> create(benchmark::State& state, const CatalogueEntry& entry,
                                     const Work& work, int threads) {
    const auto limit = limit_threads(threads);
    const std::vector<PointSource> sources = sample_sphere(work.sampling);
    SpaceOptions options = options_of(work, sources);
    options.max_bytes = std::size_t{12} << 30;
    std::unique_ptr<ControlSpaceBuilder> builder;
    double insertion = 0, gradation = 0;
    for (auto _ : state) {
        builder.reset();
        const Stopwatch watch;
        builder = entry.make(options);
        builder->insert(sources);
        const double inserted = watch.seconds();
        builder->grade({.ratio = options.ratio});
        const double graded = watch.seconds();
        state.SetIterationTime(graded);
        insertion += inserted;
        gradation += graded - inserted;
    }
    auto space = builder->build();
    const auto times = static_cast<double>(state.iterations());
    const auto leaves = static_cast<double>(space->footprint().cells);
    state.counters["insertion_ms"] = 1e3 * insertion / times;
    state.counters["gradation_ms"] = 1e3 * gradation / times;
    state.counters["sources"] = static_cast<double>(sources.size());
    state.counters["leaves"] = leaves;
    state.counters["ns_per_leaf"] = 1e9 * (insertion + gradation) / times / leaves;
    return space;
}

// A sphere of about `n` sources; the default one has 36186.
Work sphere_of(double n, bool finer) {
    Work work{"", 1, {}};
    (finer ? work.sampling.h : work.sampling.rho) *= std::sqrt(36186 / n);
    return work;
}

void grow(benchmark::State& state, const CatalogueEntry& entry, const Work& work) {
    const auto space = create(state, entry, work, 1);
    for (const auto& [order, key] :
         {std::pair(Order::random, "ns_random"), std::pair(Order::elements, "ns_elements")}) {
        state.counters[key] = access_time(*space, places(order, *space), 5).median_ns();
    }
}

template <class Run>
void add(const std::string& name, const Run& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->UseManualTime()->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
    for (const CatalogueEntry& entry : tree_catalogue()) {
        for (const Work& work : works()) {
            for (const int threads : {1, tbb::info::default_concurrency()}) {
                add("creation/" + entry.id + "/" + work.name +
                        (threads == 1 ? "/one-thread" : "/all-threads"),
                    [&, threads](benchmark::State& state) { create(state, entry, work, threads); });
            }
        }
        for (const bool finer : {true, false}) {
            for (int power = 3; power <= 7; ++power) {
                add("growth/" + entry.id + (finer ? "/finer" : "/denser") + "/sources:1e" +
                        std::to_string(power),
                    [&entry, work = sphere_of(std::pow(10, power), finer)](
                        benchmark::State& state) { grow(state, entry, work); });
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
