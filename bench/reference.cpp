// The exact field on the paper's sphere, of isotropic sources and of layered ones (four times as
// long along the sphere as across), whose cones are intersected by either rule: time to build its
// search structure on all cores, and time of a query on one, at random places, along a walk in
// steps of 0.01 in random directions, and at cell centres in their order.
#include <benchmark/benchmark.h>

#include <random>
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

enum class Places { random, walk, grid };
constexpr const char* names_of_places[] = {"random", "walk", "grid"};

// Sources, and as many places as a benchmark has time for.
struct Setting {
    std::string name;
    SphereSampling sampling;
    IntersectionRule rule;
    int places;
    int grid;
    std::vector<double> tolerances;
};

constexpr auto order_free = IntersectionRule::order_free;
constexpr auto in_turn = IntersectionRule::in_turn;
const SphereSampling layers{.s_a = 4, .s_n = 0.25, .rho = 1};
const SphereSampling dense_layers{.s_a = 4, .s_n = 0.25, .rho = 0.2};
const Setting settings[] = {
    // Isotropic answers are exact whatever the tolerance.
    {"isotropic/rho:1", {.rho = 1}, order_free, 100000, 30, {0}},
    {"isotropic/rho:0.2", {.rho = 0.2}, order_free, 100000, 30, {0}},
    {"layered/rho:1/order_free", layers, order_free, 100000, 30, {1e-2, 1e-3}},
    {"layered/rho:1/in_turn", layers, in_turn, 1000, 30, {0, 1e-2, 1e-3}},
    {"layered/rho:0.2/order_free", dense_layers, order_free, 100000, 30, {1e-2, 1e-3}},
    {"layered/rho:0.2/in_turn", dense_layers, in_turn, 100, 6, {0, 1e-2, 1e-3}},
};

std::vector<Point> random_walk(int steps) {
    constexpr double step = 0.01;
    std::mt19937 engine(1);
    std::normal_distribution<double> normal;
    std::vector<Point> places{Point::Zero()};
    while (places.size() < static_cast<std::size_t>(steps)) {
        const double x = normal(engine);
        const double y = normal(engine);
        const Point next = places.back() + step * Vector(x, y, normal(engine)).normalized();
        if (domain.contains(next)) places.push_back(next);
    }
    return places;
}

void build(benchmark::State& state, const Setting& setting) {
    const std::vector<PointSource> sources = sample_sphere(setting.sampling);
    std::size_t dropped = 0;
    for (auto _ : state) {
        dropped = ConeField(sources, g, largest, 0, setting.rule).dropped();
    }
    state.counters["sources"] = static_cast<double>(sources.size());
    state.counters["dropped"] = static_cast<double>(dropped);
}

// Evaluates all places once an iteration.
void query(benchmark::State& state, const Setting& setting, double tolerance, Places kind) {
    const ConeField field(sample_sphere(setting.sampling), g, largest, tolerance, setting.rule);
    const auto count = static_cast<std::size_t>(setting.places);
    const std::vector<Point> places = kind == Places::grid   ? cell_centres(domain, setting.grid)
                                      : kind == Places::walk ? random_walk(setting.places)
                                                             : random_points(domain, count, 1);
    std::vector<Metric> answers(places.size());
    for (auto _ : state) {
        if (field.is_isotropic()) {
            field.evaluate(places, answers);
        } else {  // in the order in which they come
            ConeField::Memory memory;
            field.evaluate(places, answers, memory);
        }
        benchmark::DoNotOptimize(answers.data());
    }
    state.counters["per_query"] = benchmark::Counter(
        static_cast<double>(places.size()),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
    for (const Setting& setting : settings) {
        benchmark::RegisterBenchmark(("build/" + setting.name).c_str(),
                                     [&](benchmark::State& state) { build(state, setting); })
            ->Unit(benchmark::kSecond)
            ->UseRealTime();
        for (const Places kind : {Places::random, Places::walk, Places::grid}) {
            for (const double tolerance : setting.tolerances) {
                std::string name =
                    "query/" + setting.name + "/" + names_of_places[static_cast<std::size_t>(kind)];
                if (tolerance > 0) name += "/tolerance:" + std::to_string(tolerance);
                benchmark::RegisterBenchmark(name.c_str(), [&setting, tolerance,
                                                            kind](benchmark::State& state) {
                    query(state, setting, tolerance, kind);
                })->Unit(benchmark::kSecond);
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
