#include "spaces/leaves_where.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "spaces/adjacency.h"

using namespace controlspace;

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
        tree.split(place, Node::even_subdivision(place.box));
    }
    return tree;
}

}  // namespace

TEMPLATE_TEST_CASE("leaves around a leaf: itself and those that share a face with it", "", KdNode,
                   OctreeNode) {
    const Topology<TestType> tree = random_tree<TestType>();
    std::vector<std::set<LeafIndex>> expected(tree.leaves());
    for_each_face_pair(tree, [&](LeafIndex a, LeafIndex b) {
        expected[a].insert(b);
        expected[b].insert(a);
    });
    tree.for_each_leaf([&](LeafIndex leaf, const Box& box) {
        expected[leaf].insert(leaf);
        std::set<LeafIndex> found;
        for_each_leaf_around(tree, box, [&](LeafIndex other, const Box& where) {
            CHECK(found.insert(other).second);
            CHECK(where == tree.locate(where.centre()).box);
        });
        CHECK(found == expected[leaf]);
    });
}

TEMPLATE_TEST_CASE("leaves at a place: all that touch it", "", KdNode, OctreeNode) {
    const Topology<TestType> tree = random_tree<TestType>();
    std::mt19937 engine(2);
    std::size_t most = 0;
    for (int i = 0; i < 100; ++i) {
        const Box box = tree.locate(random_place(engine)).box;
        const Point x = corner(box, i % 8);
        std::set<LeafIndex> expected, found;
        tree.for_each_leaf([&](LeafIndex leaf, const Box& where) {
            if (where.contains(x)) expected.insert(leaf);
        });
        for_each_leaf_at(tree, x, [&](LeafIndex leaf, const Box&) { found.insert(leaf); });
        CHECK(found == expected);
        most = std::max(most, found.size());
    }
    CHECK(most == 8);
}
