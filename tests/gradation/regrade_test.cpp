// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gradation/detail/regrade.h"

#include <catch2/catch.hpp>
#include <random>

#include "controlspace/gradation/grade.h"

namespace controlspace::regrade_test {
namespace {

constexpr double g = 1.25;

// Nodes at random places, each linked with those nearby; in flat arrays as Regradation wants them.
struct Cloud {
    using Node = NodeIndex;

    std::vector<Point> positions;
    std::vector<std::vector<NodeIndex>> links;
    std::vector<Metric> requests, holds;

    double requested(NodeIndex i) const { return requests[i].xx; }
    double field(NodeIndex i) const { return holds[i].xx; }
    void set(NodeIndex i, double h) { holds[i] = Metric::isotropic(h); }
    template <class Visit>
    void for_each_link(NodeIndex i, Visit&& visit) const {
        for (const NodeIndex j : links[i]) visit(j, Vector(positions[j] - positions[i]));
    }

    void link(NodeIndex i, NodeIndex j) {
        links[i].push_back(j);
        links[j].push_back(i);
    }
    // Takes away all links of a node; returns its neighbours.
    std::vector<NodeIndex> unlink(NodeIndex i) {
        for (const NodeIndex j : links[i]) std::erase(links[j], i);
        return std::exchange(links[i], {});
    }
    std::vector<Metric> all_graded() const {
        NodeGraph graph{positions, {0}, {}};
        for (const auto& row : links) {
            graph.neighbours.insert(graph.neighbours.end(), row.begin(), row.end());
            graph.first.push_back(graph.neighbours.size());
        }
        std::vector<Metric> metrics = requests;
        grade(graph, metrics, {.ratio = g});
        return metrics;
    }
};

double uniform(std::mt19937& engine) { return static_cast<double>(engine()) / 4294967296.0; }

Cloud random_cloud(NodeIndex n, unsigned seed) {
    std::mt19937 engine(seed);
    Cloud cloud;
    cloud.links.resize(n);
    for (NodeIndex i = 0; i < n; ++i) {
        cloud.positions.emplace_back(uniform(engine), uniform(engine), uniform(engine));
        cloud.requests.push_back(Metric::isotropic(uniform(engine) < 0.9 ? 1 : 0.02));
        for (NodeIndex j = 0; j < i; ++j) {
            if ((cloud.positions[i] - cloud.positions[j]).norm() < 0.2) cloud.link(i, j);
        }
    }
    cloud.holds = cloud.all_graded();
    return cloud;
}

}  // namespace

TEST_CASE(
    "where nodes request less: to the bit as all graded, and only what they change is visited") {
    Cloud cloud = random_cloud(400, 1);
    const std::vector<Metric> before = cloud.holds;
    Regradation regradation(cloud, g);
    const NodeIndex lowered = 17;
    cloud.requests[lowered] = cloud.holds[lowered] = Metric::isotropic(0.4 * cloud.field(lowered));
    regradation.touch(lowered);
    const GradationReport report = regradation.run(1);
    CHECK(cloud.holds == cloud.all_graded());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) changed += cloud.holds[i] != before[i] ? 1 : 0;
    CHECK(changed > 1);
    CHECK(report.visits == changed);  // each once, smallest first
    CHECK(report.operations >= changed - 1);
    CHECK(report.largest_ratio_left > 1);
    CHECK(report.largest_ratio_left <= g);
}

TEST_CASE("where nodes lose their neighbours, those that hung on them grow") {
    Cloud cloud = random_cloud(400, 2);
    std::size_t grown = 0;
    for (NodeIndex lost = 0; lost < 100; lost += 3) {
        Regradation regradation(cloud, g);
        const double held = cloud.field(lost);
        const std::vector<Metric> before = cloud.holds;
        const std::vector<NodeIndex> neighbours = cloud.unlink(lost);
        std::vector<NodeIndex> doubtful;
        for (const NodeIndex j : neighbours) {
            const Vector v = cloud.positions[j] - cloud.positions[lost];
            if (regradation.may_depend_on(j, held, v)) doubtful.push_back(j);
        }
        regradation.renew(lost);
        for (const NodeIndex j : doubtful) regradation.release(j);
        regradation.run(1);
        CHECK(cloud.holds == cloud.all_graded());
        for (std::size_t i = 0; i < before.size(); ++i) {
            grown += i != lost && cloud.field(static_cast<NodeIndex>(i)) > before[i].xx ? 1 : 0;
        }
    }
    CHECK(grown > 20);
}

TEST_CASE("new links and new nodes take part") {
    Cloud cloud = random_cloud(400, 3);
    std::mt19937 engine(4);
    for (int round = 0; round < 20; ++round) {
        Regradation regradation(cloud, g);
        const auto a = static_cast<NodeIndex>(engine() % cloud.links.size());
        const auto b = static_cast<NodeIndex>(engine() % cloud.links.size());
        const auto c = static_cast<NodeIndex>(cloud.links.size());
        if (a == b) continue;
        cloud.positions.push_back(0.5 * (cloud.positions[a] + cloud.positions[b]));
        cloud.requests.push_back(Metric::isotropic(0.02 + uniform(engine)));
        cloud.holds.push_back(Metric::isotropic(1e-3));  // whatever it is
        cloud.links.emplace_back();
        cloud.link(a, b);
        cloud.link(a, c);
        regradation.touch(a);
        regradation.touch(b);
        regradation.renew(c);
        regradation.run(1);
        CHECK(cloud.holds == cloud.all_graded());
    }
}

TEST_CASE("only the cone law by the queue, with the same ratio, is graded in part") {
    const GradationOptions by_queue{.schedule = GradationSchedule::queue};
    const PastGradation past{by_queue};
    CHECK(may_regrade(past, by_queue));
    CHECK_FALSE(may_regrade(std::nullopt, by_queue));
    CHECK_FALSE(may_regrade(past, {.schedule = GradationSchedule::queue, .ratio = 1.3}));
    for (const GradationOptions& options :
         {GradationOptions{.law = GradationLaw::mean_length},
          GradationOptions{.schedule = GradationSchedule::passes}}) {
        CHECK_FALSE(may_regrade(PastGradation{options}, options));
    }
}

}  // namespace controlspace::regrade_test
