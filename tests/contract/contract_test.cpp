// SPDX-License-Identifier: Apache-2.0
// What every structure of the catalogue promises (spaces/control_space.h), whichever it is.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>
#include <thread>

#include "contract/structure_case.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"

namespace controlspace::contract_test {

using Catch::Matchers::Contains;

namespace {

constexpr double g = 1.25;

Work any_work() {
    return GENERATE(isotropic_sphere(), anisotropic_sphere(), oblong_box(),
                    anisotropic_oblong_box(), flat_box(), anisotropic_flat_box());
}
Work any_isotropic_work() { return GENERATE(isotropic_sphere(), oblong_box(), flat_box()); }

// Length of a path along the axes by `v`, in metric `m`: no path through faces is shorter than the
// straight line, and this one always exists.
double axis_path_length(const Metric& m, const Vector& v) {
    const auto lengths = metric_edge_lengths(m, v.cwiseAbs());
    return lengths[0] + lengths[1] + lengths[2];
}

// Of positions.
double rounding(const Work& work) { return 1e-12 * std::max(1.0, work.domain.high.norm()); }

// Whether `p` is a corner of `element`, up to `rounding`.
bool is_corner(const Box& element, const Point& p, double rounding) {
    return ((p - element.low).cwiseAbs().array().min((p - element.high).cwiseAbs().array()) <
            rounding)
        .all();
}

}  // namespace

STRUCTURE_CASE(does_not_round,
               "a new control space holds H I everywhere, H half of the domain's diagonal") {
    const Work work = any_isotropic_work();
    CAPTURE(work.name);
    const auto space = editable(structure.make(work.options()));
    for (const Metric& m : answers(*space, random_points(work.domain, 100, 1))) {
        CHECK(nonconformity(m, Metric::isotropic(work.domain.half_diagonal())) < 1e-12);
    }
    CHECK(space->domain() == work.domain);
}

STRUCTURE_CASE(every_structure,
               "columns of sources are inserted as an array is, and stay as they are") {
    Work work = GENERATE(isotropic_sphere(), anisotropic_sphere());
    CAPTURE(work.name);
    work.sources.resize(work.sources.size() / 4);
    const std::size_t half = work.sources.size() / 2;
    const auto sources = std::span(work.sources).first(half);
    const auto more = std::span(work.sources).subspan(half);
    const SourceColumns columns = columns_of(sources);
    const auto by_columns = structure.make(work.options());
    const auto by_array = structure.make(work.options());
    const auto require_same = [&] {
        const std::vector<Point> x = random_points(work.domain, 1000, 3);
        CHECK(answers(*by_columns->build(), x) == answers(*by_array->build(), x));
    };
    const InsertionReport report = by_columns->insert(columns);
    const InsertionReport expected = by_array->insert(sources);
    CHECK(report.sources == expected.sources);
    CHECK(report.inserted == expected.inserted);
    require_same();
    by_columns->insert(columns_of(more));
    by_array->insert(more);
    by_columns->grade({.ratio = g});
    by_array->grade({.ratio = g});
    require_same();
    CHECK(std::ranges::equal(columns.all(), sources));

    SourceColumns refused = columns_of(sources);
    refused.add(std::vector<PointSource>{{work.domain.high + Vector(1, 0, 0), {}}});
    CHECK_THROWS_WITH(by_columns->insert(refused), Contains(fmt::format("source {} at", half)));
    by_columns->grade({.ratio = g});
    require_same();
}

STRUCTURE_CASE(does_not_round,
               "with all neighbours, no node is larger than with those across faces alone") {
    const Work work = isotropic_sphere();
    CAPTURE(work.name);
    SpaceOptions options = work.options();
    const auto graded = [&](Neighbourhood neighbourhood) {
        auto space = editable(structure.make(options));
        space->insert(work.sources);
        const auto report = space->grade(
            {.schedule = GradationSchedule::queue, .ratio = g, .neighbourhood = neighbourhood});
        CHECK(report.largest_ratio_left <= g * (1 + 1e-4));
        return space;
    };
    const ControlNodes few = graded(Neighbourhood::faces)->control_nodes(Neighbourhood::all);
    const ControlNodes all = graded(Neighbourhood::all)->control_nodes(Neighbourhood::all);
    REQUIRE(few.metrics.size() == all.metrics.size());
    if (structure.has<KeptSources>()) {
        CHECK(few.metrics == all.metrics);
        return;
    }
    CHECK(largest_gradation(few.graph, few.metrics, GradationLaw::cone) > 1.01 * g);
    CHECK(largest_gradation(all.graph, all.metrics, GradationLaw::cone) <= g * (1 + 1e-4));
    std::size_t larger = 0;
    std::size_t smaller = 0;
    for (std::size_t i = 0; i < all.metrics.size(); ++i) {
        larger += all.metrics[i].xx > few.metrics[i].xx;
        smaller += all.metrics[i].xx < 0.99 * few.metrics[i].xx;
    }
    CHECK(larger == 0);
    CHECK(smaller > 0);
}

// Not so for tensors: a node that is thin along the way lets all its lengths grow fast, those too
// that a source further back holds down. The cone of that source is lost in the intersection.
STRUCTURE_CASE(does_not_round,
               "under the cone law, no larger than the cones of the sources allow along a path") {
    const Work work = any_isotropic_work();
    CAPTURE(work.name);
    const std::vector<Point> x = random_points(work.domain, 400, 3);
    const auto space = editable(structure.make(work.options()));
    std::vector<PointSource> inserted;
    for (const PointSource& source : work.sources) {
        if (space->insert(source) == Insertion::inserted) inserted.push_back(source);
    }
    space->grade({.ratio = g});
    const std::vector<Metric> m = answers(*space, x);
    double worst = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const Vector here = space->cell_at(x[k]).value().edges();
        for (std::size_t i = 0; i < inserted.size(); i += 5) {
            const PointSource& source = inserted[i];
            const Vector there = space->cell_at(source.position).value().edges();
            // From the source to a control node of its element, along a path of control nodes
            // that may stray by a part of the elements it passes, to one of the element here.
            const double path = axis_path_length(source.metric, x[k] - source.position) +
                                axis_path_length(source.metric, here) +
                                axis_path_length(source.metric, there);
            worst = std::max(worst, growth(m[k], (1 + (g - 1) * path) * source.metric));
        }
    }
    CHECK(worst <= 1);
}

STRUCTURE_CASE(stores_a_field, "a control node's own metric at its own place") {
    const Work work = any_isotropic_work();
    CAPTURE(work.name);
    const auto space = work.graded(structure);
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    std::visit(
        [&](const auto& graph) {
            double worst = 0;
            std::size_t requested = 0;
            for (NodeIndex i = 0; i < graph.size(); i += 5) {
                const Point p = graph.position(i);
                // A hanging vertex counts in the finer elements at it only.
                if (structure.order == 1 &&
                    !is_corner(space->cell_at(p).value(), p, rounding(work)))
                    continue;
                const double delta = nonconformity(sample_at(*space, p), nodes.metrics[i]);
                worst = std::max(worst, delta);
                ++requested;
            }
            CHECK(requested > graph.size() / 50);
            CHECK(worst < 1e-12);
        },
        nodes.graph);
}

STRUCTURE_CASE(does_not_round,
               "a constant is answered as such, and assigning what was read changes nothing") {
    const Work work = GENERATE(anisotropic_sphere(), anisotropic_oblong_box());
    CAPTURE(work.name);
    const std::vector<Point> x = random_points(work.domain, 500, 4);
    const Metric constant{0.2, 0.3, 0.25, 0.01, -0.02, 0.03};
    const auto space = work.graded(structure);
    const std::vector<Metric> before = answers(*space, x);
    ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    const bool has_nodes = dynamic_cast<NodeBuilder*>(&space->builder()) != nullptr;
    REQUIRE(has_nodes == structure.has<MetricNodes>());
    if (!has_nodes) return;
    space->assign(nodes.metrics);
    CHECK(answers(*space, x) == before);
    nodes.metrics.push_back(constant);
    CHECK_THROWS_WITH(space->assign(nodes.metrics), Contains("give one for each"));
    nodes.metrics.resize(nodes.metrics.size() - 2);
    CHECK_THROWS_AS(space->assign(nodes.metrics), InputError);
    CHECK_THROWS_AS(space->assign({}), InputError);
    CHECK(answers(*space, x) == before);
    nodes.metrics.push_back(constant);
    std::fill(nodes.metrics.begin(), nodes.metrics.end(), constant);
    space->assign(nodes.metrics);
    for (const Metric& m : answers(*space, x)) CHECK(nonconformity(m, constant) < 1e-12);
}

STRUCTURE_CASE(does_not_round,
               "one by one, in a batch, in any order, from many threads: the same answers",
               "[threads]") {
    const Work work = GENERATE(isotropic_sphere(), anisotropic_sphere(), anisotropic_oblong_box());
    CAPTURE(work.name);
    const Vector beyond = work.domain.edges() / 16;  // some are outside of the domain
    const std::vector<Point> x =
        random_points({work.domain.low - beyond, work.domain.high + beyond}, 1500, 5);
    std::vector<std::size_t> order(x.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(6));
    const auto space = work.graded(structure);
    const std::vector<Metric> batch = answers(*space, x);
    std::vector<double> lengths(x.size());
    space->built().sample_lengths(x, lengths);
    for (std::size_t i = 0; i < x.size(); i += 10) {
        CHECK(space->built().metric_at(x[i]) == batch[i]);
        CHECK(space->built().length_at(x[i]) == lengths[i]);
    }

    std::vector<Point> shuffled;
    for (const std::size_t i : order) shuffled.push_back(x[i]);
    const std::vector<Metric> other = answers(*space, shuffled);
    bool same = true;
    for (std::size_t i = 0; i < order.size(); ++i) same = same && other[i] == batch[order[i]];
    CHECK(same);

    std::vector<std::vector<Metric>> concurrent(4);
    std::vector<std::thread> threads;
    for (auto& out : concurrent) threads.emplace_back([&] { out = answers(*space, x); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& out : concurrent) CHECK(out == batch);
}

STRUCTURE_CASE(does_not_round, "the same run gives the same bits, one by one as well as in a batch",
               "[long]") {
    const Work work = any_work();
    CAPTURE(work.name);
    const std::vector<Point> x = random_points(work.domain, 2000, 8);
    const auto first = work.graded(structure);
    const auto second = editable(structure.make(work.options()));
    for (const PointSource& source : work.sources) second->insert(source);
    second->grade({});
    CHECK(checksum(answers(*first, x)) == checksum(answers(*second, x)));
}

STRUCTURE_CASE(does_not_round, "sources of no use are not sources: refused by every structure") {
    const Work work = any_isotropic_work();
    CAPTURE(work.name);
    const auto space = editable(structure.make(work.options()));
    CHECK_THROWS_WITH(space->insert({work.domain.high + Vector(0.5, 0, 0), {}}),
                      Catch::Contains("outside"));
    CHECK_THROWS_WITH(space->insert({work.domain.centre(), {1, 1, 1, 3, 0, 0}}),
                      Catch::Contains("not positive definite"));
    CHECK(answers(*space, random_points(work.domain, 10, 1)) ==
          answers(*editable(structure.make(work.options())), random_points(work.domain, 10, 1)));
}

}  // namespace controlspace::contract_test
