// SPDX-License-Identifier: Apache-2.0
// The exact field on the paper's sphere, of isotropic sources and of layered ones (four times as
// long along the sphere as across), whose cones are intersected by either rule: time to build its
// search structure on all cores, and time of a query on one, at random places, along a walk in
// steps of 0.01 in random directions, and at the corners, middles and centres of leaves of an
// octree. Order-free, also against the number of sources, up to a million, for lengths along the
// sphere that are 4 and 100 times those across.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "cones/cone_field.h"
#include "controlspace/measure/access_time.h"
#include "works.h"

using namespace controlspace;

namespace {

constexpr double g = 1.25;
const Box& domain = bench_domain();
const Metric largest = Metric::isotropic(domain.half_diagonal());

enum class Places { random, walk, leaves };
constexpr const char* names_of_places[] = {"random", "walk", "leaves"};
constexpr Places kinds[] = {Places::random, Places::walk, Places::leaves};

// Sources, and as many places as a benchmark has time for.
struct Setting {
    std::string name;
    SphereSampling sampling;
    IntersectionRule rule;
    int places;
    int steps;  ///< of the walk
    std::vector<double> tolerances;
};

constexpr auto order_free = IntersectionRule::order_free;
constexpr auto in_turn = IntersectionRule::in_turn;
const SphereSampling layers{.s_a = 4, .s_n = 0.25, .rho = 1};
const SphereSampling dense_layers{.s_a = 4, .s_n = 0.25, .rho = 0.2};
const Setting settings[] = {
    // Isotropic answers are exact whatever the tolerance.
    {"isotropic/rho:1", {.rho = 1}, order_free, 100000, 100000, {0}},
    {"isotropic/rho:0.2", {.rho = 0.2}, order_free, 100000, 100000, {0}},
    {"layered/rho:1/order_free", layers, order_free, 20000, 100000, {1e-2, 1e-3}},
    {"layered/rho:1/in_turn", layers, in_turn, 1000, 1000, {0}},
    {"layered/rho:0.2/order_free", dense_layers, order_free, 10000, 100000, {1e-2, 1e-3}},
    {"layered/rho:0.2/in_turn", dense_layers, in_turn, 100, 100, {0}},
};

SphereSampling sphere_of(double sources, double anisotropy) {
    constexpr double sources_at_rho_1 = 36186;
    return {.s_a = 4, .s_n = 1 / anisotropy, .rho = std::sqrt(sources_at_rho_1 / sources)};
}

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

// 27 places of each leaf of an octree over the domain, of an edge up to 1.5 times the length across
// the nearest layer, where random places lie.
std::vector<Point> places_of_leaves(const SphereSampling& sampling, int count) {
    constexpr std::size_t of_leaf = 27;
    std::vector<Point> places;
    for (const Point& p : random_points(domain, static_cast<std::size_t>(count) / of_leaf, 1)) {
        const double away = std::abs((p - sampling.centre).norm() - sampling.radius);
        const double length = sampling.h * sampling.s_a * sampling.s_n + (g - 1) * away;
        double edge = domain.edges().x();
        while (edge > 1.5 * length) edge /= 2;
        const Point low = domain.low + edge * ((p - domain.low) / edge).array().floor().matrix();
        for (int i = 0; i < static_cast<int>(of_leaf); ++i) {
            places.push_back(low + 0.5 * edge * Vector(i % 3, i / 3 % 3, i / 9));
        }
    }
    return places;
}

std::vector<Point> places_of(const Setting& setting, Places kind) {
    switch (kind) {
        case Places::walk:
            return random_walk(setting.steps);
        case Places::leaves:
            return places_of_leaves(setting.sampling, setting.places);
        case Places::random:
            break;
    }
    return random_points(domain, static_cast<std::size_t>(setting.places), 1);
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
    const std::vector<Point> places = places_of(setting, kind);
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
    count_queries(state, places.size());
}

void register_queries(const Setting& setting, double tolerance, Places kind) {
    std::string name =
        "query/" + setting.name + "/" + names_of_places[static_cast<std::size_t>(kind)];
    if (tolerance > 0) name += "/tolerance:" + std::to_string(tolerance);
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        query(state, setting, tolerance, kind);
    })->Unit(benchmark::kSecond);
}

}  // namespace

int main(int argc, char** argv) {
    for (const Setting& setting : settings) {
        benchmark::RegisterBenchmark(("build/" + setting.name).c_str(),
                                     [&](benchmark::State& state) { build(state, setting); })
            ->Unit(benchmark::kSecond)
            ->UseRealTime();
        for (const Places kind : kinds) {
            for (const double tolerance : setting.tolerances) {
                register_queries(setting, tolerance, kind);
            }
        }
    }
    for (const int anisotropy : {4, 100}) {
        for (const int sources : {1000, 10000, 100000, 1000000}) {
            const std::string name =
                "anisotropy:" + std::to_string(anisotropy) + "/sources:" + std::to_string(sources);
            const Setting setting{name, sphere_of(sources, anisotropy), order_free, 2000, 10000,
                                  {}};
            for (const Places kind : {Places::random, Places::walk}) {
                for (const double tolerance : {1e-2, 1e-3}) {
                    register_queries(setting, tolerance, kind);
                }
            }
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
