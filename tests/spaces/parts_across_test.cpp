// SPDX-License-Identifier: Apache-2.0
#include "trees/topology/parts_across.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "controlspace/space/split_rule.h"
#include "geometry/random_fractions.h"
#include "trees/topology/adjacency.h"

namespace controlspace::parts_across_test {
namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1.5, 1)};

// A tree whose leaves get small near places drawn at random, some of them on planes of cuts.
template <class Node>
Topology<Node> grown(SplitRule rule) {
    Topology<Node> tree(domain);
    RandomFractions fraction(3);
    for (int i = 0; i < 150; ++i) {
        Point x =
            domain.low + Vector(fraction(), fraction(), fraction()).cwiseProduct(domain.edges());
        if (i % 5 == 0) x[i % 3] = domain.centre()[i % 3];
        const PointSource source{x, Metric::isotropic(0.05)};
        for (int level = 0; level < 6; ++level) {
            const LeafPlace place = tree.locate(x);
            if constexpr (Node::is_octant) {
                if (level < 3) {
                    tree.split(place, Node::even_subdivision(domain, place.level, place.box));
                }
            } else {
                const Subdivision halves = cut(rule, place.box, source, 1);
                if (halves.is_proper()) tree.split(place, halves);
            }
        }
    }
    return tree;
}

struct Leaf {
    int visits = 0;
    Box box;
    PartsAcross across;
};

// Visits come on several threads.
template <class Node>
std::vector<Leaf> leaves_of(const Topology<Node>& tree) {
    std::vector<Leaf> leaves(tree.leaves());
    for_each_parts_across(tree, [&](LeafIndex leaf, const Box& box, const PartsAcross& across) {
        leaves[leaf] = {leaves[leaf].visits + 1, box, across};
    });
    return leaves;
}

template <class Node>
void check_parts_across(const Topology<Node>& tree) {
    RandomFractions fraction(4);
    int inner = 0;
    LeafIndex leaf = 0;
    for (const auto& [visits, box, across] : leaves_of(tree)) {
        REQUIRE(visits == 1);
        REQUIRE(tree.find(box.centre()) == leaf);
        Box inside = box;  // what belongs to the leaf
        for (Axis a = 0; a < 3; ++a) inside.low[a] = std::nextafter(box.low[a], box.high[a]);
        for (int face = 0; face < 6; ++face) {
            const Ref part = across[static_cast<std::size_t>(face)];
            Point beyond = inside.low;
            if (!step_across(tree.domain(), box, face, beyond)) {
                REQUIRE(part.is_leaf());
                REQUIRE(part.index() == leaf);
                continue;
            }
            // It holds all places across the face.
            std::set<std::size_t> children;
            for (int i = 0; i < 16; ++i) {
                Point y = corner(inside, i);
                if (i >= 8) {
                    y = box.low +
                        Vector(fraction(), fraction(), fraction()).cwiseProduct(box.edges());
                    y = y.cwiseMax(inside.low);
                }
                step_across(tree.domain(), box, face, y);
                REQUIRE(tree.leaf_in(part, y).index() == tree.find(y));
                if (!part.is_leaf()) children.insert(tree.node(part).child_with(y));
            }
            // No child does.
            if (part.is_leaf()) continue;
            ++inner;
            REQUIRE(children.size() > 1);
        }
        ++leaf;
    }
    CHECK(inner > 100);
}

}  // namespace

TEST_CASE("the part across a face holds all there, and no smaller part does") {
    check_parts_across(grown<OctreeNode>(SplitRule::middle));
    for (const SplitRule rule : {SplitRule::middle, SplitRule::golden, SplitRule::metric}) {
        check_parts_across(grown<KdNode>(rule));
    }
}

TEST_CASE("a tree of one leaf has itself across all faces") {
    const std::vector<Leaf> leaves = leaves_of(Topology<KdNode>(domain));
    REQUIRE(leaves.size() == 1);
    CHECK(leaves[0].visits == 1);
    CHECK(leaves[0].box == domain);
    for (const Ref part : leaves[0].across) CHECK(part.index() == 0);
}

}  // namespace controlspace::parts_across_test
