// SPDX-License-Identifier: Apache-2.0
// Background meshes of CGAL's tetrahedra: laws of linear interpolation on them.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "case_of_each.h"
#include "controlspace/gradation/grade.h"
#include "controlspace/input_errors.h"
#include "controlspace/measure/reference.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "peers/places.h"
#include "space/saved.h"

namespace controlspace {
std::vector<CatalogueEntry> tets_rows();
}  // namespace controlspace

namespace controlspace::tets_test {
namespace {

std::vector<PointSource> some_sources(std::size_t count, const Box& box = oblong) {
    std::vector<PointSource> sources;
    for (const Point& x : places_in(box, count)) {
        const double h = 0.02 + 0.1 * std::abs(x.x() - box.low.x());
        sources.push_back({x, layer_metric(Vector(1, 2, 2) / 3, h, 3 * h)});
    }
    return sources;
}

std::unique_ptr<ControlSpaceBuilder> made(const CatalogueEntry& row, const Box& box = oblong) {
    return row.make({.domain = box});
}

NodeBuilder& nodes_of(ControlSpaceBuilder& builder) { return dynamic_cast<NodeBuilder&>(builder); }

/// A builder of the sources whose nodes hold what `field` gives at their places.
template <class Field>
std::unique_ptr<ControlSpace> filled_by(const CatalogueEntry& row, const Field& field) {
    const auto builder = made(row);
    builder->insert(some_sources(60));
    std::vector<Metric> metrics;
    const ControlNodes nodes = nodes_of(*builder).control_nodes(Neighbourhood::faces);
    for (const Point& x : positions(nodes.graph)) metrics.push_back(field(x));
    nodes_of(*builder).assign(metrics);
    return builder->build();
}

double largest_departure(const ControlSpace& space, const auto& field) {
    double largest = 0;
    for (const Point& x : places_in(oblong, 2000)) {
        largest = std::max(largest, nonconformity(sample_at(space, x), field(x)));
    }
    return largest;
}

/// Linear in each component; positive definite all over the box.
Metric linear(const Point& p) {
    const Vector t = p - oblong.low;
    return {1 + t.x(), 2 + t.y(), 1.5 + t.z(), 0.1 * t.x(), -0.1 * t.y(), 0.2 * t.z() - 0.1};
}

/// Lengths whose logarithms are linear, along axes that are not the coordinates'.
Metric of_linear_logarithms(const Point& p) {
    const Vector t = p - oblong.low;
    const Eigen::Matrix3d turned =
        Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5).normalized().toRotationMatrix();
    return metric_from_frame(
        {std::exp(t.x() - t.y()), std::exp(2 * t.y() - t.z()), std::exp(0.5 * t.z())}, turned);
}

const CatalogueEntry& linear_row() {
    static const auto rows = tets_rows();
    return rows.at(0);
}
const CatalogueEntry& log_row() {
    static const auto rows = tets_rows();
    return rows.at(1);
}

CASE_OF_EACH(row, tets_rows(), "vertices answer their metric") {
    const auto builder = made(row);
    const auto sources = some_sources(200);
    CHECK(builder->insert(sources).inserted == 200);
    const auto space = builder->build();
    for (const PointSource& source : sources) {
        CHECK(nonconformity(sample_at(*space, source.position), source.metric) < 1e-6);
    }
}

TEST_CASE("tets-linear reproduces a linear field, tets-log one of linear logarithms") {
    CHECK(largest_departure(*filled_by(linear_row(), linear), linear) < 1e-10);
    CHECK(largest_departure(*filled_by(log_row(), of_linear_logarithms), of_linear_logarithms) <
          1e-8);
    // Neither reproduces the other's.
    CHECK(largest_departure(*filled_by(log_row(), linear), linear) > 1e-3);
    CHECK(largest_departure(*filled_by(linear_row(), of_linear_logarithms), of_linear_logarithms) >
          1e-2);
}

CASE_OF_EACH(row, tets_rows(), "graded from node to node no edge grows faster than g_r") {
    const auto builder = made(row);
    builder->insert(some_sources(300));
    const auto growth = [&] {
        const ControlNodes nodes = nodes_of(*builder).control_nodes(Neighbourhood::faces);
        return largest_gradation(nodes.graph, nodes.metrics, GradationLaw::cone);
    };
    CHECK(growth() > 1.3);
    builder->grade({.schedule = GradationSchedule::queue, .ratio = 1.2});
    CHECK(growth() <= 1.2 * (1 + 1e-6));
}

CASE_OF_EACH(row, tets_rows(), "graded by the sources vertices take the exact field") {
    const auto builder = made(row);
    const auto sources = some_sources(100);
    builder->insert(sources);
    builder->grade({.ratio = 1.25});
    const auto nodes = nodes_of(*builder).control_nodes(Neighbourhood::faces);
    const auto exact = exact_reference(sources, 1.25, largest_metric(oblong));
    double largest = 0;
    for (NodeIndex i = 0; i < nodes.metrics.size(); ++i) {
        const Point x = positions(nodes.graph)[i];
        largest = std::max(largest, nonconformity(nodes.metrics[i], sample_at(*exact, x)));
    }
    CHECK(largest < 1e-2);
}

CASE_OF_EACH(row, tets_rows(), "answers do not depend on the order of places or sources") {
    auto sources = some_sources(150);
    const auto answers = [&](const std::vector<Point>& x) {
        const auto builder = made(row);
        builder->insert(sources);
        builder->grade({.schedule = GradationSchedule::queue});
        std::vector<Metric> m(x.size());
        builder->build()->sample(x, m);
        return m;
    };
    auto x = places_in(oblong, 1000);
    const auto forwards = answers(x);
    std::ranges::reverse(x);
    std::ranges::reverse(sources);
    auto backwards = answers(x);
    std::ranges::reverse(backwards);
    for (std::size_t i = 0; i < x.size(); ++i) {
        CHECK(is_positive_definite(forwards[i]));
        CHECK(nonconformity(forwards[i], backwards[i]) < 1e-6);
    }
}

CASE_OF_EACH(row, tets_rows(), "places outside answer as the nearest of the box") {
    const auto builder = made(row);
    builder->insert(some_sources(50));
    const auto space = builder->build();
    for (const Point& out : places_in({Point(-9, -9, -9), Point(9, 9, 9)}, 200)) {
        const Point in = out.cwiseMax(oblong.low).cwiseMin(oblong.high);
        CHECK(nonconformity(sample_at(*space, out), sample_at(*space, in)) < 1e-9);
    }
}

CASE_OF_EACH(row, tets_rows(), "sources at one place and in a plane") {
    const auto builder = made(row);
    std::vector<PointSource> sources{{oblong.low, Metric::isotropic(0.3)},
                                     {Point(2, -1.5, 3.5), Metric::isotropic(0.2)},
                                     {Point(2, -1.5, 3.5), Metric::isotropic(0.1)},
                                     {Point(2, -1.5, 3.5), Metric::isotropic(0.4)}};
    for (int i = 0; i <= 10; ++i) {
        sources.push_back({Point(1 + 0.2 * i, -1.5, 4), Metric::isotropic(0.25)});
        sources.push_back({Point(2, -2 + 0.1 * i, 3), Metric::isotropic(0.25)});
    }
    builder->insert(sources);
    const auto space = builder->build();
    CHECK(space->footprint().control_nodes == 8 + 1 + 22);
    CHECK(sample_at(*space, oblong.low).xx == Approx(0.3));
    CHECK(sample_at(*space, Point(2, -1.5, 3.5)).xx == Approx(0.1));
    for (const Point& x : places_in(oblong, 500)) {
        CHECK(is_positive_definite(sample_at(*space, x)));
    }
}

CASE_OF_EACH(row, tets_rows(), "a flat domain has triangles") {
    const Box flat{Point(0, 1, 0.3), Point(2, 2, 0.3)};
    const auto builder = made(row, flat);
    std::vector<PointSource> sources;
    for (const Point& x : places_in(flat, 100)) {
        sources.push_back({x, Metric::isotropic(0.01 + 0.1 * x.x())});
    }
    builder->adapt({.sources = sources, .continuous = {}, .target = 0.1});
    const auto exact = exact_reference(sources, 1.25, largest_metric(flat));
    const auto space = builder->build();
    double largest = 0;
    for (const Point& x : places_in(flat, 2000)) {
        largest = std::max(largest, nonconformity(sample_at(*space, x), sample_at(*exact, x)));
    }
    CHECK(largest <= 0.1);
    CHECK(space->footprint().cells > 10);
}

CASE_OF_EACH(row, tets_rows(), "on a sphere far from the exact field unless adapted") {
    const auto sources = sample_sphere({.h = 0.15});
    const Box box{Point(-1, -1, -1), Point(1, 1, 1)};
    const auto exact = exact_reference(sources, 1.25, largest_metric(box));
    const auto departure = [&](ControlSpaceBuilder& builder) {
        const auto space = builder.build();
        double largest = 0;
        for (const Point& x : places_in(box, 3000)) {
            largest = std::max(largest, nonconformity(sample_at(*space, x), sample_at(*exact, x)));
        }
        return largest;
    };
    const auto graded = made(row, box);
    graded->insert(sources);
    graded->grade({.ratio = 1.25});
    // Inside, vertices on the sphere alone know nothing of the middle.
    CHECK(departure(*graded) > 0.2);
    CHECK(departure(*graded) < 1);

    const auto adapted = made(row, box);
    const AdaptationReport report =
        adapted->adapt({.sources = sources, .continuous = {}, .target = 0.1});
    CHECK(report.met);
    CHECK(departure(*adapted) < 0.1);
    CHECK(adapted->build()->footprint().control_nodes < graded->build()->footprint().control_nodes);
}

CASE_OF_EACH(row, tets_rows(), "narrow peaks between sources are found: the middle of a sphere") {
    const auto sources = sample_sphere({.h = 0.04});
    const Box box{Point(-1, -1, -1), Point(1, 1, 1)};
    const auto builder = made(row, box);
    AdaptationGoal goal;
    goal.sources = sources;
    goal.target = 0.02;
    CHECK(builder->adapt(goal).met);
    std::vector<Point> x;
    for (int i = 0; i < 61 * 61 * 61; ++i) {
        x.push_back(Point(i % 61, i / 61 % 61, i / (61 * 61)) / 30 - Point(1, 1, 1));
    }
    std::vector<Metric> own(x.size()), wanted(x.size());
    builder->build()->sample(x, own);
    exact_reference(sources, goal.ratio, largest_metric(box))->sample(x, wanted);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        largest = std::max(largest, nonconformity(own[i], wanted[i]));
    }
    CHECK(largest <= goal.target);
}

CASE_OF_EACH(row, tets_rows(), "a smaller target gives a finer mesh that is nearer") {
    const auto sources = sample_sphere({.h = 0.15});
    std::size_t nodes = 0;
    double reached = 1;
    for (const double target : {0.4, 0.02}) {
        const auto builder = made(row, {Point(-1, -1, -1), Point(1, 1, 1)});
        const auto report =
            builder->adapt({.sources = sources, .continuous = {}, .target = target});
        CHECK(report.reached < reached);
        CHECK(builder->build()->footprint().control_nodes > nodes);
        reached = report.reached;
        nodes = builder->build()->footprint().control_nodes;
    }
}

TEST_CASE("a background mesh says what it cannot do") {
    CHECK_THROWS_AS(linear_row().make({.domain = oblong, .takes_later_sources = true}), InputError);
    const auto small = linear_row().make({.domain = oblong, .max_bytes = 100000});
    CHECK_THROWS_AS(small->insert(some_sources(1000)), MemoryLimitError);
    const auto builder = made(linear_row());
    auto sources = some_sources(3);
    sources[2].position.x() = 17;
    CHECK_THROWS_WITH(builder->insert(sources), Catch::Contains("source 2"));
    CHECK(builder->build()->footprint().control_nodes == 10);
}

CASE_OF_EACH(row, tets_rows(), "adaptation ends where the next tetrahedra would outgrow the cap") {
    constexpr std::size_t cap = 400000;
    const auto builder =
        row.make({.domain = {Point(-1, -1, -1), Point(1, 1, 1)}, .max_bytes = cap});
    const auto sources = sample_sphere({.h = 0.1});
    AdaptationGoal goal;
    goal.sources = sources;
    goal.target = 0.01;
    const AdaptationReport report = builder->adapt(goal);
    CHECK_FALSE(report.met);
    CHECK(report.shortfall.find("cap on memory") != std::string::npos);
    const std::size_t bytes = builder->build()->footprint().bytes_total();
    CHECK(bytes <= cap);
    CHECK(bytes > cap / 5);  // the number of the next tetrahedra is estimated: 0.24 and 0.67 of it
}

CASE_OF_EACH(row, tets_rows(), "what was saved answers alike") {
    const auto builder = made(row);
    builder->insert(some_sources(50));
    builder->grade({});
    StateWriter state;
    dynamic_cast<Saved&>(*builder).save(state);
    const auto other = made(row);
    dynamic_cast<SavedBuilder&>(*other).load(StateReader(state.bytes(), "a state"));
    const auto a = builder->build(), b = other->build();
    for (const Point& x : places_in(oblong, 300)) {
        CHECK(nonconformity(sample_at(*a, x), sample_at(*b, x)) < 1e-9);
    }
}

CASE_OF_EACH(row, tets_rows(), "adaptation leaves no triangles without height along a border") {
    const Box plane{Point(0, 0, 0), Point(2, 1, 0)};
    // Beside the border by rounding.
    const std::vector<PointSource> sources{{Point(1.2, 7e-16, 0), Metric::isotropic(0.02)},
                                           {Point(0.4, 1 - 3e-16, 0), Metric::isotropic(0.03)}};
    const auto builder = made(row, plane);
    AdaptationGoal goal;
    goal.sources = sources;
    goal.target = 0.02;
    builder->adapt(goal);
    const auto nodes = positions(nodes_of(*builder).control_nodes(Neighbourhood::faces).graph);
    std::size_t close = 0;
    for (const Point& a : nodes) {
        for (const Point& b : nodes) close += a != b && (a - b).norm() < 1e-9 ? 1 : 0;
    }
    CHECK(close <= 2 * sources.size());
}

}  // namespace

}  // namespace controlspace::tets_test
