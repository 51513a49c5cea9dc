// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/leaves_where.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "spaces/face_pairs.h"
#include "trees/topology/touching_pairs.h"

namespace controlspace::leaves_where_test {
namespace {

const Box domain{Point(-1, -2, 0), Point(1, 1, 1.5)};

Point random_place(std::mt19937& engine) {
    Point x;
    for (Axis a = 0; a < 3; ++a) {
        x[a] = domain.low[a] + domain.edges()[a] * static_cast<double>(engine()) / 4294967296.0;
    }
    return x;
}

template <class Node>
Topology<Node> random_tree() {
    Topology<Node> tree(domain);
    std::mt19937 engine(1);
    for (int i = 0; i < 200; ++i) {
        const LeafPlace place = tree.locate(random_place(engine));
        tree.split(place, Node::even_subdivision(domain, place.level, place.box));
    }
    return tree;
}

}  // namespace

TEMPLATE_TEST_CASE("leaves that touch: every pair once", "", KdNode, OctreeNode) {
    const Topology<TestType> tree = random_tree<TestType>();
    std::vector<Box> boxes(tree.leaves());
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) { boxes[leaf] = box; });
    std::set<std::pair<LeafIndex, LeafIndex>> expected, found;
    for (LeafIndex a = 0; a < boxes.size(); ++a) {
        for (LeafIndex b = 0; b < a; ++b) {
            const Point low = boxes[a].low.cwiseMax(boxes[b].low);
            const Point high = boxes[a].high.cwiseMin(boxes[b].high);
            if ((low.array() <= high.array()).all()) expected.insert({b, a});
        }
    }
    for_each_touching_pair(
        tree, [&](LeafIndex a, LeafIndex b) { CHECK(found.insert(std::minmax(a, b)).second); });
    CHECK(found == expected);
}

TEMPLATE_TEST_CASE("leaves around a leaf: itself and its neighbours", "", KdNode, OctreeNode) {
    const Topology<TestType> tree = random_tree<TestType>();
    const auto neighbourhood = GENERATE(Neighbourhood::faces, Neighbourhood::all);
    std::vector<std::set<LeafIndex>> expected(tree.leaves());
    const auto enter = [&](LeafIndex a, LeafIndex b) {
        expected[a].insert(b);
        expected[b].insert(a);
    };
    if (neighbourhood == Neighbourhood::faces) {
        for_each_face_pair(tree, enter);
    } else {
        for_each_touching_pair(tree, enter);
    }
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
        expected[leaf].insert(leaf);
        std::set<LeafIndex> found;
        for_each_leaf_around(tree, box, neighbourhood, [&](LeafIndex other, const Box& where) {
            CHECK(found.insert(other).second);
            CHECK(where == tree.locate(where.centre()).box);
        });
        CHECK(found == expected[leaf]);
    });
}

}  // namespace controlspace::leaves_where_test
