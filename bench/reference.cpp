// The exact field on the paper's sphere, of isotropic sources and of layered ones (four times as
// long along the sphere as across): time to build its search structure on all cores, and time of a
// query on one, at random places and at cell centres in their order.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "cones/cone_field.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/sources/sampled_surfaces.h"

using namespace controlspace;

namespace {

constexpr double g = 1.25;
const Box domain{Point::Constant(-1), Point::Constant(1)};
const Metric largest = Metric::isotropic(domain.half_diagonal());

// Sources, and as many places as a benchmark has time for.
struct Setting {
    std::string name;
    SphereSampling sampling;
    std::size_t random_places;
    int grid;
};

const Setting settings[] = {
    {"isotropic/rho:1", {.rho = 1}, 100000, 30},
    {"isotropic/rho:0.2", {.rho = 0.2}, 100000, 30},
    {"layered/rho:1", {.s_a = 4, .s_n = 0.25, .rho = 1}, 1000, 30},
    {"layered/rho:0.2", {.s_a = 4, .s_n = 0.25, .rho = 0.2}, 100, 6},
};

void build(benchmark::State& state, const Setting& setting) {
    const std::vector<PointSource> sources = sample_sphere(setting.sampling);
    std::size_t dropped = 0;
    for (auto _ : state) dropped = ConeField(sources, g, largest).dropped();
    state.counters["sources"] = static_cast<double>(sources.size());
    state.counters["dropped"] = static_cast<double>(dropped);
}

// Asks for all places once an iteration.
void query(benchmark::State& state, const Setting& setting, double tolerance,
           const std::vector<Point>& places) {
    const ConeField field(sample_sphere(setting.sampling), g, largest, tolerance);
    std::vector<Metric> answers(places.size());
    for (auto _ : state) {
        field.evaluate(places, answers);
        benchmark::DoNotOptimize(answers.data());
    }
    state.counters["per_query"] = benchmark::Counter(
        static_cast<double>(places.size()),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void add_query(const Setting& setting, const std::string& places, double tolerance) {
    std::string name = "query/" + setting.name + "/" + places;
    if (tolerance > 0) name += "/tolerance:" + std::to_string(tolerance);
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        query(state, setting, tolerance,
              places == "random" ? random_points(domain, setting.random_places, 1)
                                 : cell_centres(domain, setting.grid));
    })->Unit(benchmark::kSecond);
}

}  // namespace

int main(int argc, char** argv) {
    for (const Setting& setting : settings) {
        benchmark::RegisterBenchmark(("build/" + setting.name).c_str(),
                                     [&](benchmark::State& state) { build(state, setting); })
            ->Unit(benchmark::kSecond)
            ->UseRealTime();
        for (const char* places : {"random", "grid"}) {
            add_query(setting, places, 0);
            // Isotropic answers are exact whatever the tolerance.
            if (setting.sampling.s_n == 1) continue;
            add_query(setting, places, 1e-4);
            add_query(setting, places, 1e-3);
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
