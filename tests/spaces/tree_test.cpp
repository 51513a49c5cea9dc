// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "case_of_each.h"
#include "controlspace/metric/nonconformity.h"
#include "editable_space.h"
#include "geometry/random_fractions.h"
#include "spaces/face_pairs.h"
#include "trees/control_nodes.h"
#include "trees/sample_leaves.h"
#include "trees/values/constant_values.h"
#include "trees/values/quadratic_values.h"
#include "trees/values/vertex_values.h"

namespace controlspace::tree_test {
namespace {

const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};

std::vector<PointSource> scattered(int n, unsigned seed) {
    std::mt19937 engine(seed);
    const auto uniform = [&] { return static_cast<double>(engine()) / 4294967296.0; };
    std::vector<PointSource> sources;
    for (int i = 0; i < n; ++i) {
        const Point x(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
        sources.push_back({x, Metric::isotropic(0.02 + 0.3 * uniform() * uniform())});
    }
    return sources;
}

std::vector<Point> places(int n, unsigned seed) {
    std::vector<Point> all;
    for (const PointSource& s : scattered(n, seed)) all.push_back(s.position);
    return all;
}

// Levels of the face neighbours of all leaves: the largest difference.
template <class Node>
int steepest_level_jump(const Topology<Node>& tree) {
    std::vector<int> level(tree.leaves());
    tree.for_each_leaf(
        [&](LeafIndex leaf, const Box& box) { level[leaf] = tree.locate(box.centre()).level; });
    int jump = 0;
    for_each_face_pair(tree, [&](LeafIndex a, LeafIndex b) {
        jump = std::max(jump, std::abs(level[a] - level[b]));
    });
    return jump;
}

// The elements of a control space, as the distinct boxes that answer for the sources.
int level_of(const Box& box) {
    return static_cast<int>(std::lround(std::log2(2 / box.edges().x())));
}

std::vector<CatalogueEntry> linear_trees() {
    std::vector<CatalogueEntry> found;
    std::ranges::copy_if(tree_catalogue(), std::back_inserter(found),
                         [](const CatalogueEntry& entry) { return entry.order == 1; });
    return found;
}

}  // namespace

TEMPLATE_TEST_CASE("a split alone changes no metric of a leaf", "", ConstantValues<OctreeNode>,
                   QuadraticValues<OctreeNode>) {
    Topology<OctreeNode> tree(domain);
    TestType model({.domain = domain});
    std::mt19937 engine(3);
    for (int i = 0; i < 30; ++i) {
        const PointSource source = scattered(1, static_cast<unsigned>(i))[0];
        const LeafPlace place = tree.locate(source.position);
        const std::vector<Point> x = places(50, 99);
        std::vector<Metric> before;
        for (const Point& p : x) before.push_back(model.metrics()[tree.find(p)]);
        const auto first_new = static_cast<LeafIndex>(tree.leaves());
        const Subdivision s = octants(place.box);
        tree.split(place, s);
        model.split(s, place.leaf, first_new);
        for (std::size_t k = 0; k < x.size(); ++k) {
            CHECK(model.metrics()[tree.find(x[k])] == before[k]);
        }
        model.lower(tree.locate(source.position).cell(), source.metric);
    }
}

TEST_CASE("a split alone changes nothing between vertices, but for hanging ones") {
    Topology<OctreeNode> tree(domain);
    VertexValues<OctreeNode> model({.domain = domain});
    const std::vector<Point> x = places(200, 99);
    const auto field = [&] {
        std::vector<double> values;
        for (const Point& p : x) values.push_back(value_at(tree, model, p).xx);
        return values;
    };
    const auto split = [&](const Point& at) {
        const LeafPlace place = tree.locate(at);
        const auto first_new = static_cast<LeafIndex>(tree.leaves());
        const Subdivision s = octants(place.box);
        tree.split(place, s);
        model.split(s, place.leaf, first_new);
    };
    split(Point::Zero());
    for (const Point& corner_of : {Point(-0.5, -0.5, -0.5), Point(0.5, 0.5, 0.5)}) {
        model.lower(tree.locate(corner_of).cell(), Metric::isotropic(0.3));
    }
    SECTION("where no neighbour is finer, the field stays") {
        const std::vector<double> before = field();
        for (int c = 0; c < 8; ++c) split(octants(domain).child(c).centre());
        const std::vector<double> after = field();
        for (std::size_t i = 0; i < x.size(); ++i)
            CHECK(after[i] == Approx(before[i]).epsilon(1e-14));
    }
    SECTION("a finer neighbour's vertices begin to count: never larger") {
        split(Point(-0.5, -0.5, -0.5));
        const Point inner(-0.1, -0.1, -0.1);
        model.lower(tree.locate(inner).cell(), Metric::isotropic(0.1));
        const std::vector<double> before = field();
        split(Point(0.5, -0.5, -0.5));
        const std::vector<double> after = field();
        for (std::size_t i = 0; i < x.size(); ++i) CHECK(after[i] <= before[i] * (1 + 1e-14));
    }
}

CASE_OF_EACH(entry, linear_trees(),
             "vertices of leaves are shared: as many control nodes as distinct places") {
    for (const SplitRule split : {SplitRule::middle, SplitRule::golden, SplitRule::metric}) {
        CAPTURE(static_cast<int>(split));
        const auto space = editable(entry.make({.domain = domain, .split = split}));
        space->insert(scattered(300, 4));
        const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
        const auto& graph = std::get<NodeGraph>(nodes.graph);
        std::set<std::array<double, 3>> distinct;
        for (const Point& p : graph.positions) distinct.insert({p.x(), p.y(), p.z()});
        CHECK(distinct.size() == graph.size());
        CHECK(space->footprint().control_nodes == graph.size());
        // Every corner of every element that answers somewhere is one of them.
        for (const Point& x : places(500, 5)) {
            const Box leaf = space->cell_at(x).value();
            for (int i = 0; i < 8; ++i) {
                const Point c = corner(leaf, i);
                CHECK(distinct.count({c.x(), c.y(), c.z()}) == 1);
            }
        }
    }
}

TEST_CASE("vertices request the least of the leaves around them, which are those of K_L and K_oL") {
    const auto [of_leaves, of_vertices] =
        GENERATE(std::pair("K_L", "K_V"), std::pair("K_oL", "K_oV"));
    const SplitRule split = GENERATE(SplitRule::middle, SplitRule::golden, SplitRule::metric);
    const Box box = GENERATE(Box(domain), Box{Point(2, 0, 1), Point(5, 1, 2)},
                             Box{Point(-1, -1, 0.5), Point(1, 1, 0.5)});
    CAPTURE(of_vertices, static_cast<int>(split), to_string(box));
    std::vector<PointSource> sources = scattered(300, 4);
    for (PointSource& s : sources) {
        s.position = box.low + (0.5 * (s.position + Point::Ones())).cwiseProduct(box.edges());
    }
    const SpaceOptions options{.domain = box, .split = split};
    const auto leaves = editable(tree_named(of_leaves).make(options));
    const auto vertices = editable(tree_named(of_vertices).make(options));
    CHECK(vertices->insert(sources).inserted == leaves->insert(sources).inserted);

    using Place = std::array<double, 3>;
    const auto key = [](const Point& p) { return Place{p.x(), p.y(), p.z()}; };
    std::map<Place, double> least;
    const ControlNodes centres = leaves->control_nodes(Neighbourhood::faces);
    const auto& leaf_graph = std::get<NodeGraph>(centres.graph);
    for (NodeIndex i = 0; i < leaf_graph.size(); ++i) {
        const Box leaf = leaves->cell_at(leaf_graph.position(i)).value();
        CHECK(vertices->cell_at(leaf_graph.position(i)) == leaf);
        for (int c = 0; c < 8; ++c) {
            const auto [at, is_new] = least.insert({key(corner(leaf, c)), centres.metrics[i].xx});
            at->second = std::min(at->second, centres.metrics[i].xx);
        }
    }
    const ControlNodes nodes = vertices->control_nodes(Neighbourhood::faces);
    const auto& graph = std::get<NodeGraph>(nodes.graph);
    std::map<Place, double> found;
    for (NodeIndex i = 0; i < graph.size(); ++i) {
        found[key(graph.position(i))] = nodes.metrics[i].xx;
    }
    CHECK(graph.size() == least.size());
    CHECK(found == least);
}

CASE_OF_EACH(entry, tree_catalogue(),
             "inserted at once, or one by one and read in between: the same field, to the bit") {
    const auto sources = scattered(120, 11);
    const auto at_once = editable(entry.make({.domain = domain}));
    const auto one_by_one = editable(entry.make({.domain = domain}));
    at_once->insert(sources);
    const std::vector<Point> x = places(300, 12);
    const auto answers = [&](const ControlSpace& space) {
        std::vector<Metric> metrics(x.size());
        space.sample(x, metrics);
        return metrics;
    };
    for (std::size_t i = 0; i < sources.size(); ++i) {
        one_by_one->insert(sources[i]);
        if (i % 10 == 0) CHECK(answers(*one_by_one).size() == x.size());
    }
    CHECK(answers(*one_by_one) == answers(*at_once));
    at_once->grade({});
    one_by_one->grade({});
    CHECK(answers(*one_by_one) == answers(*at_once));
}

TEST_CASE("vertex neighbours are joined by an edge of a leaf: along one axis") {
    const auto space = editable(tree_named("K_V").make({.domain = domain}));
    space->insert(scattered(200, 6));
    const ControlNodes nodes = space->control_nodes(Neighbourhood::faces);
    const auto& graph = std::get<NodeGraph>(nodes.graph);
    for (NodeIndex i = 0; i < graph.size(); ++i) {
        std::size_t neighbours = 0;
        graph.for_each_neighbour(i, [&](NodeIndex j) {
            const Vector v = graph.position(j) - graph.position(i);
            CHECK((v.array() != 0).count() == 1);
            ++neighbours;
        });
        CHECK(neighbours >= 3);
    }
}

TEMPLATE_TEST_CASE("with all neighbours, any two vertices of a leaf are neighbours", "", KdNode,
                   OctreeNode) {
    Topology<TestType> tree(domain);
    VertexValues<TestType> model({.domain = domain});
    for (const Point& x : places(60, 8)) {
        const LeafPlace place = tree.locate(x);
        const auto first_new = static_cast<LeafIndex>(tree.leaves());
        const Subdivision s = TestType::even_subdivision(domain, place.level, place.box);
        tree.split(place, s);
        model.split(s, place.leaf, first_new);
    }
    using Place = std::array<double, 3>;
    const auto key = [](const Point& p) { return Place{p.x(), p.y(), p.z()}; };
    std::set<std::pair<Place, Place>> expected, found;
    tree.for_each_leaf([&](LeafIndex, const Box& leaf) {
        for (int i = 0; i < 8; ++i) {
            for (int j = 0; j < 8; ++j) {
                if (i != j) expected.insert({key(corner(leaf, i)), key(corner(leaf, j))});
            }
        }
    });
    const ControlNodes nodes = nodes_of_tree(tree, model, Neighbourhood::all);
    const auto& graph = std::get<NodeGraph>(nodes.graph);
    for (NodeIndex i = 0; i < graph.size(); ++i) {
        graph.for_each_neighbour(i, [&](NodeIndex j) {
            CHECK(found.insert({key(graph.position(i)), key(graph.position(j))}).second);
        });
    }
    CHECK(found == expected);
}

TEST_CASE("leaf neighbours: all across the faces, or the nearest across each") {
    const auto space = editable(tree_named("K_L").make({.domain = domain}));
    space->insert(scattered(200, 7));
    const ControlNodes all = space->control_nodes(Neighbourhood::faces);
    const ControlNodes nearest = space->control_nodes(Neighbourhood::nearest_per_face);
    const auto& faces = std::get<NodeGraph>(all.graph);
    const auto& links = std::get<NodeGraph>(nearest.graph);
    REQUIRE(faces.size() == links.size());
    CHECK(faces.positions == links.positions);
    CHECK(all.metrics == nearest.metrics);
    for (NodeIndex i = 0; i < faces.size(); ++i) {
        std::set<NodeIndex> across;
        faces.for_each_neighbour(i, [&](NodeIndex j) { across.insert(j); });
        std::size_t n = 0;
        links.for_each_neighbour(i, [&](NodeIndex j) {
            CHECK(across.count(j) == 1);
            ++n;
        });
        CHECK(n <= 6);
        CHECK(n <= across.size());
    }
    // Depth first: a node's position finds its own leaf, and neighbours in order share an ancestor.
    for (NodeIndex i = 0; i < faces.size(); ++i) {
        CHECK(sample_at(*space, faces.position(i)) == all.metrics[i]);
    }
}

TEST_CASE("K_oLB has the metrics of K_oL, in leaves that are balanced after insertion") {
    RandomFractions fraction(3);
    const auto place = [&] { return 2 * fraction() - 1; };
    std::vector<PointSource> sources;
    for (int i = 0; i < 300; ++i) {
        const double h = 0.002 * std::pow(100.0, fraction());
        sources.push_back({Point(place(), place(), place()), Metric::isotropic(h)});
    }
    const auto made = [&](const char* structure, bool in_turn, std::size_t first) {
        const auto builder =
            tree_named(structure).make({.domain = domain, .vertices_in_turn = in_turn});
        builder->insert(std::span(sources).first(first));
        builder->insert(std::span(sources).subspan(first));
        return builder->build();
    };
    std::vector<Point> x(5000);
    for (Point& p : x) p = Point(place(), place(), place());
    const auto metrics = [&](const ControlSpace& space) {
        std::vector<Metric> out(x.size());
        space.sample(x, out);
        return out;
    };
    const std::vector<Metric> plain = metrics(*made("K_oL", false, 0));
    const auto balanced = made("K_oLB", false, 0);
    CHECK(metrics(*balanced) == plain);
    const auto in_parts = made("K_oLB", false, 100);
    CHECK(metrics(*in_parts) == plain);
    CHECK(in_parts->footprint().cells == balanced->footprint().cells);
    // As published, sources find leaves that were cut for others.
    CHECK(metrics(*made("K_oLB", true, 0)) != plain);
}

TEST_CASE("K_oLB is balanced after every insertion, and K_oL is not") {
    const std::vector<PointSource> sources{{Point(0.01, 0.01, 0.01), Metric::isotropic(0.01)},
                                           {Point(-0.9, 0.3, 0.2), Metric::isotropic(0.05)},
                                           {Point(-0.01, 0.6, -0.3), Metric::isotropic(0.004)}};
    const auto jump = [](const ControlSpace& space) {
        const auto nodes = control_nodes(space, Neighbourhood::faces).value();
        const auto& graph = std::get<NodeGraph>(nodes.graph);
        int largest = 0;
        for (NodeIndex i = 0; i < graph.size(); ++i) {
            graph.for_each_neighbour(i, [&](NodeIndex j) {
                largest = std::max(largest, level_of(space.cell_at(graph.position(j)).value()) -
                                                level_of(space.cell_at(graph.position(i)).value()));
            });
        }
        return largest;
    };
    const auto plain = editable(tree_named("K_oL").make({.domain = domain}));
    const auto balanced = editable(tree_named("K_oLB").make({.domain = domain}));
    for (const PointSource& source : sources) {
        plain->insert(source);
        balanced->insert(source);
        CHECK(jump(*balanced) <= 1);
    }
    CHECK(jump(*plain) > 1);
    CHECK(balanced->footprint().cells > plain->footprint().cells);
}

CASE_OF_EACH(entry, tree_catalogue(),
             "leaves at a source are no longer than l_min in its metric, and not much shorter") {
    for (const double l_min : {1.0, 0.3}) {
        CAPTURE(l_min);
        const auto space = editable(entry.make({.domain = domain, .l_min = l_min}));
        const PointSource source{Point(0.3, -0.2, 0.7), Metric::isotropic(0.05)};
        CHECK(space->insert(source) == Insertion::inserted);
        const Vector edges = space->cell_at(source.position).value().edges();
        CHECK(edges.maxCoeff() <= l_min * 0.05);
        CHECK(edges.minCoeff() > 0.25 * l_min * 0.05);
        // K_Li blends in the neighbours, which are still large: not met before gradation.
        if (entry.order < 2) CHECK(space->insert(source) == Insertion::already_met);
    }
}

CASE_OF_EACH(entry, tree_catalogue(), "the depth limits are kept") {
    const PointSource tiny{Point(0.1, 0.2, 0.3), Metric::isotropic(1e-9)};
    const auto space = editable(entry.make({.domain = domain, .kd_depth = 7, .octree_depth = 3}));
    space->insert(tiny);
    CHECK(space->footprint().depth == (entry.has<SplitRules>() ? 7 : 3));
}

CASE_OF_EACH(entry, tree_catalogue(), "where floating point ends, splitting stops") {
    const Box small{Point::Constant(1), Point::Constant(1 + 1e-9)};
    const auto space = editable(entry.make({.domain = small, .kd_depth = 200, .octree_depth = 60}));
    CHECK(space->insert({small.centre(), Metric::isotropic(1e-30)}) == Insertion::inserted);
    CHECK(space->footprint().depth < 3 * 24);
}

TEST_CASE("options out of range are refused by name") {
    const auto refuses = [](const SpaceOptions& options, const std::string& word) {
        CHECK_THROWS_WITH(tree_named("K_L").make(options), Catch::Contains(word));
    };
    refuses({.domain = {Point::Zero(), Point(1, 1, -1)}}, "no extent along z");
    refuses({.domain = {Point::Zero(), Point(1, 0, 0)}}, "no extent along two axes");
    refuses({.domain = {Point::Zero(), Point(1, NAN, 1)}}, "no extent along y");
    refuses({.domain = domain, .l_min = 0}, "l_min");
    refuses({.domain = domain, .l_min = NAN}, "l_min");
    refuses({.domain = domain, .tolerance = -1}, "tolerance");
    refuses({.domain = domain, .kd_depth = 201}, "kd-trees");
    refuses({.domain = domain, .octree_depth = 1000}, "octrees");
    refuses({.domain = domain, .octree_depth = -1}, "octrees");
    refuses({.domain = domain, .split = SplitRule(77)}, "split is 77");
    refuses({.domain = domain, .quadratic_form = QuadraticForm(2)}, "quadratic_form is 2");
    for (const CatalogueEntry& entry : anchored_catalogue()) {
        for (const double ratio : {-3.0, 0.99, double(NAN), double(INFINITY)}) {
            CHECK_THROWS_WITH(entry.make({.domain = domain, .ratio = ratio}),
                              Catch::Contains("gradation ratio"));
        }
    }
}

CASE_OF_EACH(entry, tree_catalogue(),
             "sources that are no sources are refused, and leave the space as it was") {
    const auto space = editable(entry.make({.domain = domain}));
    const auto refuses = [&](const PointSource& source, const std::string& word) {
        CHECK_THROWS_WITH(space->insert(source), Catch::Contains(word));
    };
    refuses({Point(2, 0, 0), {}}, "outside the domain");
    refuses({Point(NAN, 0, 0), {}}, "outside the domain");
    refuses({Point::Zero(), {1, -1, 1, 0, 0, 0}}, "not positive definite");
    refuses({Point::Zero(), {1, 1, 1, 2, 0, 0}}, "not positive definite");
    refuses({Point::Zero(), {1, 1, NAN, 0, 0, 0}}, "not positive definite");
    const std::vector<PointSource> batch{{Point::Zero(), {}}, {Point(0, -3, 0), {}}};
    CHECK_THROWS_WITH(space->insert(batch), Catch::Contains("source 1 at (0, -3, 0)"));
}

}  // namespace controlspace::tree_test
