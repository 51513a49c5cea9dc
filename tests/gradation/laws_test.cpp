// SPDX-License-Identifier: Apache-2.0
// How gradation behaves when the unit of length, the origin or the names of the axes change: in an
// oblong box far from the origin, with metrics that have no symmetry.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "metric/draw.h"

namespace controlspace::laws_test {
namespace {

struct Nodes {
    NodeGraph graph;
    std::vector<Metric> metrics;

    std::vector<Metric> graded(const GradationOptions& options) const {
        std::vector<Metric> result = metrics;
        grade(graph, result, options);
        return result;
    }
};

// A lattice of oblong cells without each seventh node, so that neighbours are not alike. Numbers
// are short in binary: scaled by powers of two, or moved, they are exact.
Nodes oblong(double anisotropy, Neighbourhood neighbourhood) {
    const Lattice lattice{
        Point(1000, -300, 77), Vector(0.5, 0.125, 0.25), {13, 9, 5}, neighbourhood};
    Draw draw(5);
    Nodes nodes;
    std::vector<NodeIndex> name(lattice.size(), ~NodeIndex{0});
    for (NodeIndex i = 0; i < lattice.size(); ++i) {
        if (i % 7 == 6) continue;
        name[i] = static_cast<NodeIndex>(nodes.metrics.size());
        nodes.graph.positions.push_back(lattice.position(i));
        const bool is_small = draw.uniform(0, 1) < 0.05;
        nodes.metrics.push_back(!is_small        ? Metric::isotropic(3)
                                : anisotropy > 1 ? draw.metric(0.1, anisotropy)
                                                 : Metric::isotropic(draw.uniform(0.02, 0.2)));
    }
    nodes.graph.first.push_back(0);
    for (NodeIndex i = 0; i < lattice.size(); ++i) {
        if (i % 7 == 6) continue;
        lattice.for_each_neighbour(i, [&](NodeIndex j) {
            if (j % 7 != 6) nodes.graph.neighbours.push_back(name[j]);
        });
        nodes.graph.first.push_back(nodes.graph.neighbours.size());
    }
    return nodes;
}

const std::array<GradationOptions, 5> ways{
    GradationOptions{.ratio = 1.25},
    {.ratio = 1.25, .neighbourhood = Neighbourhood::all},
    {.law = GradationLaw::mean_length, .ratio = 1.5},
    {.law = GradationLaw::mean_length, .schedule = GradationSchedule::passes, .ratio = 1.5},
    {.law = GradationLaw::cone, .schedule = GradationSchedule::passes, .ratio = 2}};

}  // namespace

TEST_CASE("moved nodes are graded alike, to the bit") {
    const double anisotropy = GENERATE(1.0, 20.0);
    for (const GradationOptions& options : ways) {
        const Nodes nodes = oblong(anisotropy, options.neighbourhood);
        Nodes moved = nodes;
        for (Point& p : moved.graph.positions) p += Vector(-4096, 512.5, 0.0625);
        CHECK(moved.graded(options) == nodes.graded(options));
        CHECK(nodes.graded(options) != nodes.metrics);
    }
}

TEST_CASE("in a unit 16 times as short, nodes are graded alike, to the bit") {
    const double anisotropy = GENERATE(1.0, 20.0);
    for (const GradationOptions& options : ways) {
        const Nodes nodes = oblong(anisotropy, options.neighbourhood);
        Nodes scaled = nodes;
        for (Point& p : scaled.graph.positions) p *= 16;
        for (Metric& m : scaled.metrics) m = 16.0 * m;
        std::vector<Metric> expected = nodes.graded(options);
        for (Metric& m : expected) m = 16.0 * m;
        CHECK(scaled.graded(options) == expected);
    }
}

TEST_CASE("with axes renamed, nodes are graded alike") {
    const double anisotropy = GENERATE(1.0, 20.0);
    Eigen::Matrix3d turn;  // x to y, y to z, z to x
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    for (const GradationOptions& options : ways) {
        const Nodes nodes = oblong(anisotropy, options.neighbourhood);
        Nodes renamed = nodes;
        for (Point& p : renamed.graph.positions) p = turn * p;
        for (Metric& m : renamed.metrics) m = rotated(m, turn);
        const std::vector<Metric> expected = nodes.graded(options);
        const std::vector<Metric> found = renamed.graded(options);
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const Metric wanted = rotated(expected[i], turn);
            if (anisotropy == 1) {
                REQUIRE(found[i] == wanted);
            } else {
                REQUIRE(difference(found[i], wanted) < 1e-6);
            }
        }
    }
}

}  // namespace controlspace::laws_test
