// SPDX-License-Identifier: Apache-2.0
// Batches of queries on many threads, and single queries from many threads. Names:
//   parallel/STRUCTURE/batch:N/T-threads    one batch of N random places by sample_parallel
//   parallel/STRUCTURE/points/T-threads     T threads that each query place after place
// By the wall clock; T is 1 and all processors.
#include <benchmark/benchmark.h>
#include <tbb/info.h>

#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/threads.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/space/sample_parallel.h"
#include "works.h"

using namespace controlspace;

namespace {

// Made by the first benchmark that uses it.
const ControlSpace& space_of(const CatalogueEntry& entry) {
    static std::map<std::string, std::unique_ptr<ControlSpace>> made;
    auto& space = made[entry.id];
    if (!space) space = graded(entry, works().front())->build();
    return *space;
}

void batch(benchmark::State& state, const CatalogueEntry& entry, std::size_t n, int threads) {
    const auto limit = limit_threads(threads);
    const ControlSpace& space = space_of(entry);
    const std::vector<Point> x = random_points(space.domain(), n, 1);
    std::vector<Metric> out(n);
    for (auto _ : state) {
        sample_parallel(space, x, out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count_queries(state, n);
}

// The threads share the places evenly, and query them one by one.
void points(benchmark::State& state, const CatalogueEntry& entry, int threads) {
    constexpr std::size_t n = 200'000;
    const ControlSpace& space = space_of(entry);
    const std::vector<Point> x = random_points(space.domain(), n, 1);
    const auto ask = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Metric m = sample_at(space, x[i]);
            benchmark::DoNotOptimize(m);
        }
    };
    for (auto _ : state) {
        std::vector<std::jthread> others;
        const auto share = n / static_cast<std::size_t>(threads);
        for (int t = 1; t < threads; ++t) {
            const std::size_t begin = static_cast<std::size_t>(t) * share;
            others.emplace_back(ask, begin, begin + share);
        }
        ask(0, share);
    }
    count_queries(state, n / static_cast<std::size_t>(threads) * static_cast<std::size_t>(threads));
}

}  // namespace

int main(int argc, char** argv) {
    const int all = tbb::info::default_concurrency();
    const auto add = [](const std::string& name, int threads, auto run) {
        const std::string full = "parallel/" + name + "/" + std::to_string(threads) + "-threads";
        benchmark::RegisterBenchmark(full.c_str(), run)->UseRealTime();
    };
    for (const CatalogueEntry& entry : tree_catalogue()) {
        for (const int threads : {1, all}) {
            for (const std::size_t n : {100'000u, 1'000'000u}) {
                add(entry.id + "/batch:" + std::to_string(n), threads,
                    [&entry, n, threads](auto& state) { batch(state, entry, n, threads); });
            }
            add(entry.id + "/points", threads,
                [&entry, threads](auto& state) { points(state, entry, threads); });
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
