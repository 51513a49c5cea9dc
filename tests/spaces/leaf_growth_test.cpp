// SPDX-License-Identifier: Apache-2.0
// Many sources at once, on any number of threads, make the tree that they make one by one: the same
// nodes and metrics under the same numbers.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "case_of_each.h"
#include "controlspace/error.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"
#include "space/saved.h"
#include "space/state.h"

namespace controlspace::leaf_growth_test {
namespace {

const Box domain{Point::Constant(-1), Point::Constant(1)};

std::string state_of(const EditableSpace& space) {
    StateWriter state;
    dynamic_cast<const Saved&>(space.built()).save(state);
    return state.bytes();
}

std::string at_once(const CatalogueEntry& entry, const SpaceOptions& options,
                    std::span<const PointSource> sources, int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    std::string state;
    tbb::task_arena(threads).execute([&] {
        const auto space = editable(entry.make(options));
        space->insert(sources);
        state = state_of(*space);
    });
    return state;
}

std::vector<PointSource> shuffled(std::vector<PointSource> sources) {
    std::shuffle(sources.begin(), sources.end(), std::mt19937(5));
    return sources;
}

// On planes that trees cut at, too, and many in one place.
std::vector<PointSource> on_planes() {
    std::mt19937 engine(3);
    const auto step = [&] { return static_cast<double>(engine() % 65) / 32 - 1; };
    std::vector<PointSource> sources;
    for (int i = 0; i < 6000; ++i) {
        const double h = 0.01 + 0.1 * static_cast<double>(engine() % 8);
        const Point x = i % 5 == 0 ? Point(0.5, -0.25, 0) : Point(step(), step(), step());
        sources.push_back({x, i % 9 == 0 ? Metric{h, 2 * h, h, 0, 0, 0} : Metric::isotropic(h)});
    }
    return sources;
}

// What a new tree holds is shorter.
std::vector<PointSource> too_long_to_matter() {
    return {{Point(0.1, 0.2, 0.3), Metric::isotropic(10)},
            {Point(0.3, 0.2, 0.1), Metric{9, 8, 7, 0, 0, 0}}};
}

}  // namespace

CASE_OF_EACH(entry, tree_catalogue(),
             "many sources at once make the tree of one by one, whatever the number of threads",
             "[threads]") {
    const std::vector<PointSource> sources = GENERATE(
        too_long_to_matter(), sample_sphere({.h = 0.05, .rho = 0.5}),
        shuffled(sample_sphere({.h = 0.05})),
        shuffled(sample_sphere({.h = 0.05, .s_a = 4, .s_n = 0.25, .rho = 2})), on_planes());
    std::vector<SplitRule> splits{SplitRule::middle};
    if (entry.has<SplitRules>()) splits.push_back(SplitRule::metric);
    const SplitRule split = GENERATE_COPY(from_range(splits));
    CAPTURE(sources.size(), static_cast<int>(split));
    const SpaceOptions options{.domain = domain, .split = split, .l_min = 0.7};
    const auto one_by_one = editable(entry.make(options));
    std::uint64_t inserted = 0;
    for (const PointSource& source : sources) {
        inserted += one_by_one->insert(source) == Insertion::inserted ? 1 : 0;
    }
    const auto all = editable(entry.make(options));
    CHECK(all->insert(sources).inserted == inserted);
    CHECK(all->footprint().depth == one_by_one->footprint().depth);
    for (const int threads : {1, 2, 3, 7}) {
        CAPTURE(threads);
        CHECK((at_once(entry, options, sources, threads) == state_of(*one_by_one)));
    }
}

CASE_OF_EACH(entry, tree_catalogue(),
             "a source that is not valid stops those after it alone, whatever their number") {
    std::vector<PointSource> sources = sample_sphere({.h = 0.1});
    const std::size_t bad = sources.size() / 2;
    const std::vector<PointSource> before(sources.begin(),
                                          sources.begin() + static_cast<std::ptrdiff_t>(bad));
    sources[bad].metric = GENERATE(Metric{1, 1, 1, 3, 0, 0}, Metric::isotropic(-1));
    sources[bad + 9].position = Point(2, 0, 0);
    const SpaceOptions options{.domain = domain};
    const auto space = editable(entry.make(options));
    CHECK_THROWS_WITH(space->insert(sources),
                      Catch::Contains("source " + std::to_string(bad) + " "));
    CHECK((state_of(*space) == at_once(entry, options, before, 1)));
}

}  // namespace controlspace::leaf_growth_test
