// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/topology.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "controlspace/geometry/extent.h"
#include "controlspace/space/split_rule.h"
#include "spaces/face_pairs.h"
#include "trees/topology/adjacency.h"

namespace controlspace::topology_test {
namespace {

const Box domain{Point(-1, 0, 0.3), Point(1, 1.7, 1)};

template <class Node>
struct RandomTree {
    Box filled;
    Topology<Node> tree{filled};
    std::mt19937 engine{11};

    double uniform() { return static_cast<double>(engine()) / 4294967296.0; }
    Point place() {
        return filled.low + Vector(uniform(), uniform(), uniform()).cwiseProduct(filled.edges());
    }
    explicit RandomTree(int splits, const Box& box = domain) : filled(box) {
        for (int i = 0; i < splits; ++i) {
            const LeafPlace leaf = tree.locate(place());
            if constexpr (Node::arity == 8) {
                tree.split(leaf, Node::even_subdivision(filled, leaf.level, leaf.box));
            } else {
                auto a = static_cast<Axis>(engine() % 3);
                if (flat_axis(filled) == a) a = (a + 1) % 3;
                const double t = 0.25 + 0.5 * uniform();
                tree.split(leaf, halves(leaf.box, a, leaf.box.low[a] + t * leaf.box.edges()[a]));
            }
        }
    }
    std::vector<Box> boxes() const {
        std::vector<Box> all(tree.leaves());
        tree.for_each_leaf([&](LeafIndex leaf, const Box& box) { all[leaf] = box; });
        return all;
    }
};

}  // namespace

TEMPLATE_TEST_CASE("descents that start in the middle end at the same leaves", "", KdNode,
                   OctreeNode) {
    // In the second domain few bits are left for what lies inside; in the third axes differ much.
    // The others are flat.
    const std::array<Box, 6> domains{{domain,
                                      {Point(3e9, -2, 7e8), Point(3e9 + 1.3, -1.1, 7e8 + 1)},
                                      {Point(0, 0, 0), Point(1e-3, 0.1, 30)},
                                      {Point(0, 0, 0), Point(1, 1.5, 0)},
                                      {Point(-3, 2, 1), Point(8, 2, 2)},
                                      {Point(5, -1, -1), Point(5, 1, 1)}}};
    const Box filled = domains[GENERATE(range(0u, 6u))];
    RandomTree<TestType> random(200, filled);
    auto& tree = random.tree;
    std::vector<Point> x;
    const auto check = [&] {
        x.clear();
        const double beyond = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 300; ++i) x.push_back(random.place());
        for (const Box& box : random.boxes()) {
            for (const Point& p : {box.low, box.high, box.centre()}) {
                x.push_back(p);
                for (Axis a = 0; a < 3; ++a) {
                    Point above = p;
                    above[a] = std::nextafter(p[a], beyond);
                    x.push_back(above);
                }
            }
        }
        const Point middle = filled.centre();
        x.emplace_back(-1e30, middle.y(), beyond);
        x.emplace_back(1e30, -beyond, middle.z());
        x.emplace_back(middle.x(), std::numeric_limits<double>::quiet_NaN(), middle.z());
        for (const Point& p : x) REQUIRE(tree.find(p) == tree.locate(p).leaf);
        for (std::size_t first = 0; first < x.size(); first += 61) {
            const auto part =
                std::span(x).subspan(first, std::min<std::size_t>(61, x.size() - first));
            std::array<LeafIndex, Topology<TestType>::most_found> leaves;
            tree.find(part, leaves);
            for (std::size_t i = 0; i < part.size(); ++i) {
                REQUIRE(leaves[i] == tree.locate(part[i]).leaf);
            }
        }
    };
    check();
    CHECK(tree.bytes_of_jumps() < 200);  // one cell so far
    tree.fit_jumps();
    CHECK(tree.bytes_of_jumps() > tree.leaves());
    check();
    const std::size_t before = tree.bytes_of_jumps();
    // Later leaves are known as well, before the table is fitted again.
    for (int i = 0; i < 1000; ++i) {
        const LeafPlace leaf = tree.locate(random.place());
        tree.split(leaf, TestType::even_subdivision(filled, leaf.level, leaf.box));
    }
    CHECK(tree.bytes_of_jumps() == before);
    check();
    tree.fit_jumps();
    CHECK(tree.bytes_of_jumps() > before);
    check();
}

TEMPLATE_TEST_CASE("leaves fill the domain, and every place finds the one that holds it", "",
                   KdNode, OctreeNode) {
    RandomTree<TestType> random(60);
    const auto& tree = random.tree;
    const std::vector<Box> boxes = random.boxes();
    std::size_t leaves = 1;
    for (const TestType& node : tree.nodes()) leaves += static_cast<std::size_t>(node.count() - 1);
    CHECK(tree.leaves() == leaves);
    CHECK(tree.inner_nodes() == 60);
    double volume = 0;
    for (const Box& box : boxes) volume += box.edges().prod();
    CHECK(volume == Approx(domain.edges().prod()));

    const auto check = [&](const Point& x) {
        const LeafPlace place = tree.locate(x);
        CHECK(place.box == boxes[place.leaf]);
        CHECK(place.leaf == tree.find(x));
        // A place on a face belongs to the low side: inside, or on a high face, or at the border.
        for (Axis a = 0; a < 3; ++a) {
            CHECK((x[a] > place.box.low[a] || place.box.low[a] == domain.low[a]));
            CHECK(x[a] <= place.box.high[a]);
        }
    };
    for (int i = 0; i < 300; ++i) check(random.place());
    for (const Box& box : boxes) {
        for (int i = 0; i < 8; ++i) check(corner(box, i));
    }
}

TEMPLATE_TEST_CASE("face pairs are those that brute force finds", "", KdNode, OctreeNode) {
    const Box filled = GENERATE(Box(domain), Box{Point(0, 0, 0), Point(1, 20, 7)},
                                Box{Point(1, 2, 3), Point(4, 2, 9)});
    const RandomTree<TestType> random(40, filled);
    // Of a flat box, faces are sides of no extent across the plane.
    const auto shares_area = [&](const Vector& shared, Axis a) {
        return shared[a] > 0 || flat_axis(filled) == a;
    };
    const std::vector<Box> boxes = random.boxes();
    std::set<std::pair<LeafIndex, LeafIndex>> expected;
    for (LeafIndex i = 0; i < boxes.size(); ++i) {
        for (LeafIndex j = 0; j < boxes.size(); ++j) {
            for (Axis a = 0; a < 3; ++a) {
                if (boxes[i].high[a] != boxes[j].low[a] || flat_axis(filled) == a) continue;
                const Vector shared =
                    boxes[i].high.cwiseMin(boxes[j].high) - boxes[i].low.cwiseMax(boxes[j].low);
                if (shares_area(shared, (a + 1) % 3) && shares_area(shared, (a + 2) % 3)) {
                    expected.emplace(i, j);
                }
            }
        }
    }
    std::set<std::pair<LeafIndex, LeafIndex>> found;
    std::size_t visits = 0;
    for_each_face_pair(random.tree, [&](LeafIndex low, LeafIndex high) {
        found.emplace(low, high);
        ++visits;
    });
    CHECK(found == expected);
    CHECK(visits == expected.size());
}

TEMPLATE_TEST_CASE("the leaf across a face is the nearest one there", "", KdNode, OctreeNode) {
    RandomTree<TestType> random(40);
    for (int i = 0; i < 300; ++i) {
        const Point x = random.place();
        const LeafPlace here = random.tree.locate(x);
        for (int face = 0; face < 6; ++face) {
            const Axis a = face / 2;
            LeafPlace across;
            const double wall = face % 2 == 1 ? here.box.high[a] : here.box.low[a];
            const bool border = wall == (face % 2 == 1 ? domain.high[a] : domain.low[a]);
            REQUIRE(locate_across(random.tree, here.box, face, x, across) == !border);
            if (border) continue;
            CHECK((face % 2 == 1 ? across.box.low[a] : across.box.high[a]) == wall);
            Point projection = x;
            projection[a] = wall;
            CHECK(across.box.contains(projection));
        }
    }
}

TEST_CASE("octrees halve the long axes first, until boxes are near cubes, and a flat one never") {
    const Point low(3, -2, 0.1);
    const std::array<Vector, 6> edges{Vector(1, 1, 1),    Vector(1.9, 1, 1.2), Vector(100, 1, 1),
                                      Vector(1, 1e-3, 1), Vector(0, 3, 40),    Vector(7, 7, 0)};
    for (const Vector& e : edges) {
        const Box filled{low, low + e};
        Box box = filled;
        const bool is_near_cube = e.maxCoeff() < 2 * e.minCoeff();
        for (int level = 0; level < 20; ++level) {
            const auto axes = long_axes(filled, level);
            const Vector before = box.edges();
            for (Axis a = 0; a < 3; ++a) {
                const bool is_cut = axes[static_cast<std::size_t>(a)];
                if (is_near_cube) CHECK(is_cut);
                if (before[a] == 0) CHECK(!is_cut);
                if (before[a] > 0.51 * before.maxCoeff()) CHECK(is_cut);
                if (before[a] < 0.49 * before.maxCoeff()) CHECK(!is_cut);
            }
            box = OctreeNode::even_subdivision(filled, level, box).child(0);
        }
        const auto flat = flat_axis(filled);
        double shortest = box.edges().maxCoeff();
        for (Axis a = 0; a < 3; ++a) {
            if (a != flat) shortest = std::min(shortest, box.edges()[a]);
        }
        CHECK(box.edges().maxCoeff() < 2.001 * shortest);
    }
}

TEST_CASE("a graph from pairs lists every link at both ends, and rows can be made unique") {
    const std::vector<std::pair<NodeIndex, NodeIndex>> pairs{{0, 2}, {2, 1}, {0, 2}, {3, 0}};
    NodeGraph graph;
    link_pairs(graph, 5, pairs);
    CHECK(graph.first == std::vector<std::size_t>{0, 3, 4, 7, 8, 8});
    sort_rows_uniquely(graph);
    CHECK(graph.first == std::vector<std::size_t>{0, 2, 3, 5, 6, 6});
    CHECK(graph.neighbours == std::vector<NodeIndex>{2, 3, 2, 0, 1, 0});
}

}  // namespace controlspace::topology_test
