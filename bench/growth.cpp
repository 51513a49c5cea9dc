// How creation (insertion and gradation) and access grow with the number of sources. Names:
// growth/STRUCTURE/SERIES/sources:N. "finer": spacing and lengths of the sphere's sources shrink
// together, so that the structure grows with them; "denser": spacing alone. The time is that of
// creation; counters are the number of sources and leaves, and of access ns_random, at random
// places, and ns_elements, where elements are. One thread.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "controlspace/measure/access_time.h"
#include "works.h"

using namespace controlspace;

namespace {

// A sphere of about `n` sources; the default one has 36186.
SphereSampling sphere_of(double n, bool finer) {
    SphereSampling sampling;
    const double shrink = std::sqrt(36186 / n);
    (finer ? sampling.h : sampling.rho) *= shrink;
    return sampling;
}

void grow(benchmark::State& state, const CatalogueEntry& entry, double n, bool finer) {
    using Clock = std::chrono::steady_clock;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    const std::vector<PointSource> sources = sample_sphere(sphere_of(n, finer));
    const SpaceOptions options{.domain = bench_domain(),
                               .finest_length = finest_length(sources),
                               .max_bytes = std::size_t{12} << 30};
    std::unique_ptr<ControlSpace> space;
    for (auto _ : state) {
        space.reset();
        const auto start = Clock::now();
        const auto builder = entry.make(options);
        builder->insert(sources);
        builder->grade({.ratio = options.ratio});
        space = builder->build();
        state.SetIterationTime(std::chrono::duration<double>(Clock::now() - start).count());
    }
    const auto ns = [&](Order order) {
        return access_time(*space, places(order, *space), 5).median_ns();
    };
    state.counters["sources"] = static_cast<double>(sources.size());
    state.counters["leaves"] = static_cast<double>(space->footprint().cells);
    state.counters["ns_random"] = ns(Order::random);
    state.counters["ns_elements"] = ns(Order::elements);
}

}  // namespace

int main(int argc, char** argv) {
    for (const CatalogueEntry& entry : tree_catalogue()) {
        for (const bool finer : {true, false}) {
            for (int power = 3; power <= 7; ++power) {
                const std::string name = "growth/" + entry.id + (finer ? "/finer" : "/denser") +
                                         "/sources:1e" + std::to_string(power);
                const auto run = [&entry, finer, power](benchmark::State& state) {
                    grow(state, entry, std::pow(10, power), finer);
                };
                benchmark::RegisterBenchmark(name.c_str(), run)->UseManualTime();
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
