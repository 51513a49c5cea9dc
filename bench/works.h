// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"

namespace controlspace {

/// What structures are timed on: the paper's sphere, sampled and resolved in some way.
struct Work {
    std::string name;  ///< part of the names of benchmarks
    double tau;
    SphereSampling sampling;
};
std::span<const Work> works();

/// [-1, 1]^3.
const Box& bench_domain();

/// What structures with these sources of the work are made with.
SpaceOptions options_of(const Work& work, std::span<const PointSource> sources);

/// Counts `n` queries an iteration: the counter per_query is the seconds of one.
inline void count_queries(benchmark::State& state, std::size_t n) {
    state.counters["per_query"] =
        benchmark::Counter(static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate |
                                                       benchmark::Counter::kInvert);
}

/// A structure with the work's sources, inserted and graded. Kd-trees cut as `split` says; grids
/// have the given `voxel`, 0 as SpaceOptions has it.
std::unique_ptr<ControlSpaceBuilder> graded(const CatalogueEntry& entry, const Work& work,
                                            SplitRule split = SplitRule::middle, double voxel = 0);

/// Orders in which places are queried: uniformly random; those of a grid; where elements are
/// (drawn with density 1 / det M), random or along a Morton curve; walks of half an element's
/// length a step.
enum class Order { random, grid, elements, morton, walk };
struct NamedOrder {
    Order order;
    const char* name;
};
std::span<const NamedOrder> orders();

/// 100000 places (103823 of a grid); `field` says how long elements are.
std::vector<Point> places(Order order, const ControlSpace& field);

}  // namespace controlspace
