// The exact field on the paper's sphere: time to build its search structure on all cores, and time
// of a query on one.
#include <benchmark/benchmark.h>

#include <map>
#include <utility>

#include "cones/cone_field.h"
#include "measure/access_time.h"
#include "measure/accuracy.h"
#include "sources/sampled_surfaces.h"

using namespace controlspace;

namespace {

constexpr double g = 1.25;
const Box domain{Point::Constant(-1), Point::Constant(1)};
const Metric largest = Metric::isotropic(domain.half_diagonal());

SphereSampling isotropic(double rho) { return {.rho = rho}; }
SphereSampling layered(double rho) { return {.s_a = 4, .s_n = 0.25, .rho = rho}; }

void build(benchmark::State& state, const SphereSampling& sampling) {
    const std::vector<PointSource> sources = sample_sphere(sampling);
    std::size_t dropped = 0;
    for (auto _ : state) dropped = ConeField(sources, g, largest).dropped();
    state.counters["sources"] = static_cast<double>(sources.size());
    state.counters["dropped"] = static_cast<double>(dropped);
}

// Asks for all places once an iteration.
void query(benchmark::State& state, const SphereSampling& sampling, double tolerance,
           const std::vector<Point>& places) {
    const std::vector<PointSource> sources = sample_sphere(sampling);
    const ConeField field(sources, g, largest, tolerance);
    std::vector<Metric> answers(places.size());
    for (auto _ : state) {
        field.evaluate(places, answers);
        benchmark::DoNotOptimize(answers.data());
    }
    state.counters["sources"] = static_cast<double>(sources.size());
    state.counters["per_query"] = benchmark::Counter(
        static_cast<double>(places.size()),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const std::vector<Point> few_random_places = random_points(domain, 200, 1);
const std::vector<Point> random_places = random_points(domain, 100000, 1);
const std::vector<Point> grid_places = cell_centres(domain, 101);

}  // namespace

BENCHMARK_CAPTURE(build, isotropic, isotropic(0.2))->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(build, layered, layered(1))->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(query, isotropic_random, isotropic(0.2), 0, random_places)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(query, isotropic_grid, isotropic(0.2), 0, grid_places)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(query, layered, layered(1), 0, few_random_places)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(query, layered_to_1e_6, layered(1), 1e-6, few_random_places)
    ->Unit(benchmark::kSecond);
