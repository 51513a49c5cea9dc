// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gradation/grade.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "metric/draw.h"

namespace controlspace::grade_test {
namespace {

Lattice cube(std::uint32_t n) {
    return {Point::Zero(), Vector::Constant(1.0 / (n - 1)), {n, n, n}};
}

// The same nodes and neighbours as explicit arrays, node i renamed to names[i].
NodeGraph renamed(const Lattice& lattice, const std::vector<NodeIndex>& names) {
    NodeGraph graph;
    graph.positions.resize(lattice.size());
    std::vector<std::vector<NodeIndex>> rows(lattice.size());
    for (NodeIndex i = 0; i < lattice.size(); ++i) {
        graph.positions[names[i]] = lattice.position(i);
        lattice.for_each_neighbour(i, [&](NodeIndex j) { rows[names[i]].push_back(names[j]); });
    }
    graph.first.push_back(0);
    for (const auto& row : rows) {
        graph.neighbours.insert(graph.neighbours.end(), row.begin(), row.end());
        graph.first.push_back(graph.neighbours.size());
    }
    return graph;
}

std::vector<Metric> random_isotropic(std::size_t n, unsigned seed) {
    std::mt19937 engine(seed);
    std::vector<Metric> metrics;
    for (std::size_t i = 0; i < n; ++i) {
        const double share = static_cast<double>(engine()) / 4294967296.0;
        metrics.push_back(Metric::isotropic(share < 0.9 ? 2 : 0.02 + share - 0.9));
    }
    return metrics;
}

// How far the steepest pair is above the law: 0 where every pair keeps it.
double gradation_excess(const ControlGraph& graph, const std::vector<Metric>& metrics,
                        GradationLaw law, double g) {
    double excess = 0;
    std::visit(
        [&](const auto& nodes) {
            for (NodeIndex i = 0; i < nodes.size(); ++i) {
                nodes.for_each_neighbour(i, [&](NodeIndex j) {
                    const Growth growth = growth_between(law, metrics[i], metrics[j],
                                                         nodes.position(j) - nodes.position(i));
                    excess = std::max(excess, growth.ratio / growth.allowed(g) - 1);
                });
            }
        },
        graph);
    return excess;
}

}  // namespace

TEST_CASE("an unknown law is refused by each function that takes one") {
    const ControlGraph graph = Lattice{Point::Zero(), Vector::Ones(), {2, 1, 1}};
    std::vector<Metric> metrics{Metric::isotropic(1), Metric::isotropic(9)};
    const std::vector<Metric> before = metrics;
    const auto law = static_cast<GradationLaw>(77);
    CHECK_THROWS_WITH(grade(graph, metrics, {.law = law}), Catch::Contains("gradation is 77"));
    CHECK_THROWS_WITH(largest_gradation(graph, metrics, law), Catch::Contains("gradation is 77"));
    CHECK(metrics == before);
}

TEST_CASE("one small node: sizes grow with the length of the path along the lattice") {
    const Lattice lattice = cube(9);
    std::vector<Metric> metrics(lattice.size(), Metric::isotropic(10));
    const NodeIndex centre = lattice.index(4, 4, 4);
    metrics[centre] = Metric::isotropic(0.1);
    const GradationReport report = grade(lattice, metrics, {.ratio = 1.5});
    for (NodeIndex i = 0; i < lattice.size(); ++i) {
        const double path = (lattice.position(i) - lattice.position(centre)).lpNorm<1>();
        CHECK(metrics[i].xx == Approx(0.1 + 0.5 * path));
    }
    CHECK(report.largest_ratio_left == Approx(1.5));
    CHECK(report.operations >= lattice.size() - 1);
}

// The shortest way from node to node goes along as many diagonals as it can. It is longest, against
// the straight line, in the direction (1, √2 - 1, √3 - √2): √(9 - 2 √2 - 2 √6) = 1.128 times.
TEST_CASE("one small node and all neighbours: the path has diagonals, and is 1.13 times too long") {
    Lattice lattice = cube(25);
    lattice.neighbourhood = Neighbourhood::all;
    std::vector<Metric> metrics(lattice.size(), Metric::isotropic(10));
    const NodeIndex corner = lattice.index(0, 0, 0);
    metrics[corner] = Metric::isotropic(0.1);
    grade(lattice, metrics, {.ratio = 1.5});
    double longest = 0;
    for (NodeIndex i = 1; i < lattice.size(); ++i) {
        const Vector v = lattice.position(i) - lattice.position(corner);
        std::array<double, 3> d{v.x(), v.y(), v.z()};
        std::sort(d.begin(), d.end());
        const double path = std::sqrt(3) * d[0] + std::sqrt(2) * (d[1] - d[0]) + (d[2] - d[1]);
        CHECK(metrics[i].xx == Approx(0.1 + 0.5 * path));
        longest = std::max(longest, path / v.norm());
    }
    CHECK(longest == Approx(std::sqrt(9 - 2 * std::sqrt(2) - 2 * std::sqrt(6))).epsilon(1e-3));
}

TEST_CASE("a node of a lattice has all neighbours around it once, and is one of theirs") {
    const Lattice lattice{Point(1, 2, 3), Vector(0.1, 0.2, 0.4), {4, 3, 2}, Neighbourhood::all};
    const auto neighbours = [&](NodeIndex i) {
        std::set<NodeIndex> found;
        lattice.for_each_link(i, [&](NodeIndex j, const Vector& v) {
            CHECK(found.insert(j).second);
            CHECK((lattice.position(i) + v - lattice.position(j)).norm() < 1e-15);
        });
        return found;
    };
    for (NodeIndex i = 0; i < lattice.size(); ++i) {
        std::set<NodeIndex> expected;
        for (NodeIndex j = 0; j < lattice.size(); ++j) {
            const Vector steps =
                (lattice.position(j) - lattice.position(i)).cwiseQuotient(lattice.spacing);
            if (j != i && steps.cwiseAbs().maxCoeff() < 1.5) expected.insert(j);
        }
        CHECK(neighbours(i) == expected);
    }
}

TEST_CASE("the largest gradation is that of the steepest pair, wherever it is") {
    // Along a line, the cone law's ratio between two nodes: 1 + |h - h'| / d.
    const Lattice line{Point::Zero(), Vector(0.5, 1, 1), {5, 1, 1}};
    for (std::size_t steep = 0; steep < 4; ++steep) {
        std::vector<double> h{1, 1.1, 1.2, 1.3, 1.4};
        for (std::size_t i = steep + 1; i < 5; ++i) h[i] += 0.4;
        std::vector<Metric> metrics, reversed;
        for (const double length : h) metrics.push_back(Metric::isotropic(length));
        reversed.assign(metrics.rbegin(), metrics.rend());
        CHECK(largest_gradation(line, metrics, GradationLaw::cone) == Approx(2));
        CHECK(largest_gradation(line, reversed, GradationLaw::cone) == Approx(2));
    }
}

TEST_CASE("the queue leaves no pair above the ratio") {
    const auto law = GENERATE(GradationLaw::cone, GradationLaw::mean_length);
    const double g = GENERATE(1.1, 1.25, 2.0);
    Lattice lattice = cube(8);
    lattice.neighbourhood = GENERATE(Neighbourhood::faces, Neighbourhood::all);

    SECTION("isotropic") {
        std::vector<Metric> metrics = random_isotropic(lattice.size(), 1);
        const std::vector<Metric> before = metrics;
        const GradationReport report = grade(lattice, metrics, {law, GradationSchedule::queue, g});
        CHECK(gradation_excess(lattice, metrics, law, g) < 1e-9);
        CHECK(report.largest_ratio_left <= g * (1 + 1e-6));
        for (std::size_t i = 0; i < metrics.size(); ++i) CHECK(metrics[i].xx <= before[i].xx);

        // At rest: grading again does nothing.
        const std::vector<Metric> once = metrics;
        CHECK(grade(lattice, metrics, {law, GradationSchedule::queue, g}).operations == 0);
        CHECK(metrics == once);
    }
    SECTION("anisotropic") {
        Draw draw(7);
        std::vector<Metric> metrics(lattice.size(), Metric::isotropic(2));
        for (std::size_t i = 0; i < metrics.size(); i += 11) metrics[i] = draw.metric(0.1, 30);
        const std::vector<Metric> before = metrics;
        const GradationReport report = grade(lattice, metrics, {law, GradationSchedule::queue, g});
        CHECK(gradation_excess(lattice, metrics, law, g) < 1e-6);
        CHECK(report.largest_ratio_left <= g * (1 + 1e-4));
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            CHECK(is_within(metrics[i], 1 + 1e-9, before[i]));
            CHECK(is_positive_definite(metrics[i]));
        }
    }
}

TEST_CASE("the isotropic cone law has one fixed point, to the bit, whatever the order") {
    // Steps of a power of two, so that differences of positions are the lattice's own steps.
    const Lattice lattice{Point::Zero(), Vector(0.125, 0.25, 0.0625), {10, 9, 11}};
    const std::vector<Metric> start = random_isotropic(lattice.size(), 5);
    std::vector<Metric> reference = start;
    grade(lattice, reference, {});
    for (const unsigned seed : {1u, 2u, 3u}) {
        std::vector<NodeIndex> names(lattice.size());
        for (NodeIndex i = 0; i < names.size(); ++i) names[i] = i;
        std::shuffle(names.begin(), names.end(), std::mt19937(seed));
        std::vector<Metric> metrics(start.size());
        for (NodeIndex i = 0; i < names.size(); ++i) metrics[names[i]] = start[i];
        grade(renamed(lattice, names), metrics, {});
        for (NodeIndex i = 0; i < names.size(); ++i) CHECK(metrics[names[i]] == reference[i]);
    }
}

TEST_CASE("passes stop at ten, and say what they left") {
    // A chain whose far end is small, visited from the large end: a pass in node order carries the
    // limit back by one node only, so ten passes cannot reach the other end.
    NodeGraph chain;
    const NodeIndex n = 40;
    chain.first.push_back(0);
    for (NodeIndex i = 0; i < n; ++i) {
        chain.positions.push_back(Point(i, 0, 0));
        if (i > 0) chain.neighbours.push_back(i - 1);
        if (i + 1 < n) chain.neighbours.push_back(i + 1);
        chain.first.push_back(chain.neighbours.size());
    }
    std::vector<Metric> metrics(n, Metric::isotropic(100));
    metrics.back() = Metric::isotropic(1);
    const GradationOptions options{GradationLaw::mean_length, GradationSchedule::passes, 1.25};
    const GradationReport report = grade(chain, metrics, options);
    CHECK(metrics.front() == Metric::isotropic(100));
    CHECK(report.largest_ratio_left > 1.25 * 1.05);
    CHECK(gradation_excess(chain, metrics, options.law, options.ratio) > 0.05);

    std::vector<Metric> queued(n, Metric::isotropic(100));
    queued.back() = Metric::isotropic(1);
    CHECK(grade(chain, queued, {GradationLaw::mean_length, GradationSchedule::queue, 1.25})
              .largest_ratio_left <= 1.25 * (1 + 1e-9));
    CHECK(queued.front().xx < 100);
}

TEST_CASE("passes leave nodes alone whose neighbours are alike") {
    const Lattice lattice = cube(3);
    std::vector<Metric> metrics(lattice.size(), Metric::isotropic(1e-3));
    for (std::size_t i = 0; i < metrics.size(); i += 2) metrics[i] = Metric::isotropic(1.05e-3);
    const std::vector<Metric> before = metrics;
    const GradationOptions options{GradationLaw::mean_length, GradationSchedule::passes, 1.0};
    CHECK(grade(lattice, metrics, options).operations == 0);  // δ is 0.0041 < 0.01
    CHECK(metrics == before);
}

TEST_CASE("a lattice knows its nodes and neighbours") {
    const Lattice lattice{Point(1, 2, 3), Vector(0.5, 0.25, 2), {3, 4, 5}};
    CHECK(lattice.size() == 60);
    const NodeIndex n = lattice.index(2, 1, 3);
    CHECK(lattice.coordinates(n) == std::array<std::uint32_t, 3>{2, 1, 3});
    CHECK(lattice.position(n) == Point(2, 2.25, 9));
    std::size_t links = 0;
    for (NodeIndex i = 0; i < lattice.size(); ++i) {
        lattice.for_each_neighbour(i, [&](NodeIndex j) {
            ++links;
            const Vector v =
                (lattice.position(j) - lattice.position(i)).cwiseQuotient(lattice.spacing);
            CHECK(v.lpNorm<1>() == 1);
        });
    }
    CHECK(links == 2 * (2 * 4 * 5 + 3 * 3 * 5 + 3 * 4 * 4));
}

TEST_CASE("a ratio below 1, too large or not finite is refused") {
    const Lattice lattice = cube(2);
    std::vector<Metric> metrics(lattice.size());
    for (const double ratio : {0.99, -1.0, 1e51, std::nan(""), HUGE_VAL}) {
        CHECK_THROWS_AS(grade(lattice, metrics, {.ratio = ratio}), InputError);
    }
}

}  // namespace controlspace::grade_test
