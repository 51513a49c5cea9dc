// SPDX-License-Identifier: Apache-2.0
// Creation, insertion and gradation, of every tree of the catalogue on spheres. Names:
//   creation/STRUCTURE/WORK/one-thread and creation/STRUCTURE/WORK/all-threads
//   growth/STRUCTURE/SERIES/sources:N, on one thread; SERIES "finer": spacing and lengths of the
//   sources shrink together, so that the structure grows with them; "denser": spacing alone
// The time is that of both, by the wall clock; counters give the two apart (insertion_ms,
// gradation_ms), the number of sources and leaves, and nanoseconds for a leaf; of growth access
// too: ns_random, at random places, and ns_elements, where elements are.
//   on-cones/TIPS/sources:N            the exact field of N sources on the cones of 20 tips, which
//                                      are among the sources ("given") or not ("hidden")
//   on-cones/TIPS/K_oV/sources:N       K_oV, adapted to it within δ 0.1
//   one-leaf/STRUCTURE/sources:N       insertion of N sources 1e-6 apart with lengths of 1e-9

#include <benchmark/benchmark.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/threads.h"
#include "cones/cone_field.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/space/catalogue.h"
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

std::vector<PointSource> on_cones(std::size_t n, bool are_tips_given) {
    const Box domain = bench_domain();
    std::vector<PointSource> tips;
    for (const Point& x : random_points(domain, 20, 1)) {
        const double h = 0.005 * std::pow(1.12, static_cast<double>(tips.size()));
        tips.push_back({x, Metric::isotropic(h)});
    }
    std::vector<PointSource> sources = are_tips_given ? tips : std::vector<PointSource>();
    for (const Point& x : random_points(domain, n - sources.size(), 2)) {
        double h = domain.half_diagonal();
        for (const PointSource& tip : tips) {
            h = std::min(h, tip.metric.xx + 0.25 * (x - tip.position).norm());
        }
        sources.push_back({x, Metric::isotropic(h)});
    }
    return sources;
}

void search_cones(benchmark::State& state, std::size_t n, bool are_tips_given) {
    const std::vector<PointSource> sources = on_cones(n, are_tips_given);
    for (auto _ : state) {
        const Stopwatch watch;
        const ConeField field(sources, 1.25, largest_metric(bench_domain()));
        state.SetIterationTime(watch.seconds());
        state.counters["kept"] = static_cast<double>(n - field.dropped());
    }
}

void adapt_to_cones(benchmark::State& state, std::size_t n, bool are_tips_given) {
    const std::vector<PointSource> sources = on_cones(n, are_tips_given);
    const CatalogueEntry& entry = *find_entry(tree_catalogue(), "K_oV");
    for (auto _ : state) {
        const auto builder = entry.make({.domain = bench_domain()});
        const Stopwatch watch;
        builder->adapt({.sources = sources, .continuous = nullptr, .ratio = 1.25, .target = 0.1});
        state.SetIterationTime(watch.seconds());
        state.counters["leaves"] = static_cast<double>(builder->build()->footprint().cells);
    }
}

void insert_in_one_leaf(benchmark::State& state, const CatalogueEntry& entry, std::size_t n) {
    std::vector<PointSource> sources;
    for (const Point& x : random_points(bench_domain(), n, 3)) {
        const double reach = 0.5e-6 * std::cbrt(static_cast<double>(n));
        sources.push_back({Point(0.1, 0.1, 0.1) + reach * x, Metric::isotropic(1e-9)});
    }
    for (auto _ : state) {
        const auto builder = entry.make({.domain = bench_domain()});
        const Stopwatch watch;
        builder->insert(sources);
        state.SetIterationTime(watch.seconds());
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
    for (const std::size_t n : {25000, 50000, 100000, 200000}) {
        const std::string of = "sources:" + std::to_string(n);
        for (const bool given : {true, false}) {
            const std::string name = std::string("on-cones/") + (given ? "given/" : "hidden/");
            add(name + of, [=](benchmark::State& state) { search_cones(state, n, given); });
            add(name + "K_oV/" + of,
                [=](benchmark::State& state) { adapt_to_cones(state, n, given); });
        }
        for (const CatalogueEntry& entry : anchored_catalogue()) {
            add("one-leaf/" + entry.id + "/" + of,
                [&entry, n](benchmark::State& state) { insert_in_one_leaf(state, entry, n); });
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
