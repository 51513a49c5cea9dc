// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "baselines/fixtures.h"
#include "controlspace/error.h"
#include "controlspace/measure/reference.h"
#include "counting_allocator.h"
#include "editable_space.h"
#include "space/until_late.h"

using Catch::Matchers::Contains;

namespace controlspace::direct_test {
namespace {

SpaceOptions with_ratio(double ratio) {
    SpaceOptions options;
    options.domain = {Point(-1, -1, 2), Point(1, 0.28, 2.89)};
    options.finest_length = 0.1;
    options.ratio = ratio;
    return options;
}

std::vector<PointSource> sources_for(const SpaceOptions& options, std::size_t n, bool isotropic) {
    auto sources = random_sources(n, options);
    if (isotropic) {
        for (PointSource& s : sources) s.metric = Metric::isotropic(s.metric.xx);
    }
    return sources;
}

std::vector<Point> places(const SpaceOptions& options, std::size_t n) {
    std::mt19937_64 random(3);
    std::vector<Point> x;
    for (std::size_t i = 0; i < n; ++i) x.push_back(random_point(random, options.domain));
    return x;
}

std::vector<Metric> by_definition(const SpaceOptions& options,
                                  const std::vector<PointSource>& sources, double ratio,
                                  const std::vector<Point>& x) {
    std::vector<Metric> out(x.size());
    brute_force_reference(sources, ratio, largest_metric(options.domain))->sample(x, out);
    return out;
}

double largest_difference(const std::vector<Metric>& a, const std::vector<Metric>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, difference(a[i], b[i]));
    return largest;
}

}  // namespace

TEST_CASE("direct answers the exact field, for the ratio it is graded with") {
    const bool isotropic = GENERATE(true, false);
    SpaceOptions options = with_ratio(1.25);
    options.intersection = IntersectionRule::in_turn;
    const auto sources = sources_for(options, 300, isotropic);
    const auto x = places(options, 300);
    const auto space = make_structure("direct", options);
    CHECK(space->insert(sources).inserted == sources.size());
    CHECK(largest_difference(sample(*space, x), by_definition(options, sources, 1.25, x)) < 1e-12);
    space->grade(
        {.law = GradationLaw::mean_length, .schedule = GradationSchedule::passes, .ratio = 1.25});
    CHECK(largest_difference(sample(*space, x), by_definition(options, sources, 1.25, x)) < 1e-12);
    space->grade({.ratio = 1.6});
    CHECK(largest_difference(sample(*space, x), by_definition(options, sources, 1.6, x)) < 1e-12);
    CHECK_THROWS_AS(space->grade({.ratio = 0.9}), InputError);
}

TEST_CASE("direct answers the order-free field unless told otherwise") {
    const SpaceOptions options = with_ratio(1.25);
    const auto sources = sources_for(options, 300, false);
    const auto x = places(options, 300);
    const auto space = make_structure("direct", options);
    space->insert(sources);
    const Metric largest = largest_metric(options.domain);
    for (const double ratio : {1.25, 1.6}) {
        space->grade({.ratio = ratio});
        std::vector<Metric> expected(x.size());
        exact_reference(sources, ratio, largest, 1e-3)->sample(x, expected);
        CHECK(sample(*space, x) == expected);
        exact_reference(sources, ratio, largest, 0, IntersectionRule::in_turn)->sample(x, expected);
        CHECK(largest_difference(sample(*space, x), expected) > 0.01);
    }
}

TEST_CASE("sources that come later, between readings, count as all others do") {
    const bool isotropic = GENERATE(true, false);
    const SpaceOptions options = with_ratio(1.25);
    const auto sources = sources_for(options, 200, isotropic);
    const auto x = places(options, 100);
    const auto at_once = make_structure("direct", options);
    at_once->insert(sources);

    const auto in_turn = make_structure("direct", options);
    const std::span<const PointSource> all = sources;
    in_turn->insert(all.first(150));
    const std::vector<Metric> before = sample(*in_turn, x);
    for (const PointSource& source : all.subspan(150)) {
        CHECK(in_turn->insert(source) == Insertion::inserted);
        sample_at(*in_turn, source.position);
    }
    CHECK(sample(*in_turn, x) == sample(*at_once, x));
    CHECK(sample(*in_turn, x) != before);
}

TEST_CASE("the nodes of direct are its sources") {
    const SpaceOptions options = with_ratio(1.25);
    const auto sources = sources_for(options, 50, false);
    const auto space = make_structure("direct", options);
    space->insert(sources);
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    REQUIRE(nodes.metrics.size() == sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        CHECK(std::get<NodeGraph>(nodes.graph).positions[i] == sources[i].position);
        CHECK(nodes.metrics[i] == sources[i].metric);
    }
}

TEST_CASE("the footprint of direct is what it has allocated") {
    const bool isotropic = GENERATE(true, false);
    const SpaceOptions options = with_ratio(1.25);
    const auto sources = sources_for(options, 3000, isotropic);
    const auto build = [&] {
        const auto builder = structure_with_id("direct").make(options);
        builder->insert(sources);
        return builder->build();
    };
    build();  // whatever the task scheduler keeps to itself
    const std::size_t before = live_bytes();
    auto space = build();
    const std::size_t allocated = live_bytes() - before;
    const std::size_t counted = space->footprint().bytes_total();
    CHECK(counted <= allocated);
    CHECK(counted + 2048 >= allocated);
    space.reset();
    CHECK(live_bytes() == before);
}

TEST_CASE("direct says how many of its sources can matter") {
    const SpaceOptions options = with_ratio(1.25);
    const auto space = make_structure("direct", options);
    const PointSource governs{options.domain.centre(), Metric::isotropic(0.1)};
    space->insert(governs);
    space->insert(governs);
    space->insert({options.domain.low, Metric::isotropic(1)});
    const Footprint footprint = space->footprint();
    CHECK(footprint.control_nodes == 3);
    CHECK_THAT(footprint.remark, Contains("1 of 3 sources"));
}

TEST_CASE("direct ends the comparison with its target at a limit of time, and says so", "[long]") {
    int stop = 1;
    SpaceOptions options = with_ratio(1.25);
    const auto sources = sources_for(options, 40, false);
    const AdaptationGoal goal{
        .sources = sources, .continuous = nullptr, .ratio = 1.25, .target = 0.1};
    const auto entry = *find_entry(structures(), "direct");
    options.growth.stop = &stop;
    const auto stopped = editable(entry.make(options));
    const AdaptationReport report = stopped->adapt(goal);
    CHECK(report.stop == GrowthStop::time);
    CHECK_FALSE(report.met);
    CHECK(report.reached == std::numeric_limits<double>::infinity());
    CHECK_THAT(report.shortfall, Contains("no time was left"));
    stop = 0;
    const auto finished = editable(entry.make(options));
    CHECK(finished->adapt(goal).met);
    const auto x = places(options, 100);
    CHECK(answers(*stopped, x) == answers(*finished, x));
}

TEST_CASE("what has a limit of time is sampled no further than some places beyond it") {
    struct Counted final : ControlSpace {
        void sample(std::span<const Point> x, std::span<Metric> out) const override {
            std::ranges::fill(out, Metric::isotropic(1));
            sampled += x.size();
            stop = 1;
        }
        mutable std::size_t sampled = 0;
        mutable int stop = 0;
    };
    const Counted space;
    GrowthLimit limit;
    limit.stop = &space.stop;
    std::vector<Point> x(5000, Point::Zero());
    std::vector<Metric> out(x.size());
    CHECK_THROWS_AS(UntilLate(space, limit).sample(x, out), GrowthStopped);
    CHECK(space.sampled <= 500);
}

TEST_CASE("direct refuses a ratio that is none") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double ratio : {0.5, nan, std::numeric_limits<double>::infinity()}) {
        CHECK_THROWS_WITH(make_structure("direct", with_ratio(ratio)), Contains("g_r"));
    }
}

}  // namespace controlspace::direct_test
