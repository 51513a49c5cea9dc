#include "controlspace/trees/topology.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "controlspace/space/split_rule.h"
#include "controlspace/trees/detail/adjacency.h"
#include "spaces/face_pairs.h"

using namespace controlspace;

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
                tree.split(leaf, octants(leaf.box));
            } else {
                const Axis a = static_cast<Axis>(engine() % 3);
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
    const std::array<Box, 3> domains{{domain,
                                      {Point(3e9, -2, 7e8), Point(3e9 + 1.3, -1.1, 7e8 + 1)},
                                      {Point(0, 0, 0), Point(1e-3, 0.1, 30)}}};
    const Box filled = domains[GENERATE(0u, 1u, 2u)];
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
        tree.split(leaf, TestType::even_subdivision(leaf.box));
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
    CHECK(tree.leaves() == 1 + 60u * (TestType::arity - 1));
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
    const RandomTree<TestType> random(40);
    const std::vector<Box> boxes = random.boxes();
    std::set<std::pair<LeafIndex, LeafIndex>> expected;
    for (LeafIndex i = 0; i < boxes.size(); ++i) {
        for (LeafIndex j = 0; j < boxes.size(); ++j) {
            for (Axis a = 0; a < 3; ++a) {
                if (boxes[i].high[a] != boxes[j].low[a]) continue;
                const Vector shared =
                    boxes[i].high.cwiseMin(boxes[j].high) - boxes[i].low.cwiseMax(boxes[j].low);
                if (shared[(a + 1) % 3] > 0 && shared[(a + 2) % 3] > 0) expected.emplace(i, j);
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

TEST_CASE("a graph from pairs lists every link at both ends, and rows can be made unique") {
    const std::vector<std::pair<NodeIndex, NodeIndex>> pairs{{0, 2}, {2, 1}, {0, 2}, {3, 0}};
    NodeGraph graph = graph_from_pairs(5, pairs);
    CHECK(graph.first == std::vector<std::size_t>{0, 3, 4, 7, 8, 8});
    sort_rows_uniquely(graph);
    CHECK(graph.first == std::vector<std::size_t>{0, 2, 3, 5, 6, 6});
    CHECK(graph.neighbours == std::vector<NodeIndex>{2, 3, 2, 0, 1, 0});
}
