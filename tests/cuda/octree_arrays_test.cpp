// SPDX-License-Identifier: Apache-2.0
// Octrees as arrays for a GPU answer as octrees do, to the bit: by the kernels' functions, called
// here.
#include "cuda/octree_arrays.h"

#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"
#include "geometry/random_fractions.h"

namespace controlspace::octree_arrays_test {

using Catch::Matchers::Contains;

namespace {

std::vector<PointSource> some_sources(const Box& domain, bool tensors) {
    RandomFractions random(3);
    std::vector<PointSource> sources;
    const Vector edges = domain.edges();
    for (int i = 0; i < 60; ++i) {
        const Vector t(random(), random(), random());
        const double h = (0.01 + 0.1 * random()) * edges.maxCoeff();
        Metric m = Metric::isotropic(h);
        if (tensors) m = {h, 0.5 * h, 0.3 * h, 0.1 * h, 0.05 * h, -0.02 * h};
        sources.push_back({domain.low + t.cwiseProduct(edges), m});
    }
    return sources;
}

// At random, on planes of the tree and of the domain, and outside.
std::vector<Point> some_places(const Box& domain) {
    RandomFractions random(5);
    std::vector<Point> places;
    for (int i = 0; i < 3000; ++i) {
        Vector t(random(), random(), random());
        if (i % 3 == 1) t = (16 * t).array().round() / 16;
        if (i % 3 == 2) t = 1.4 * t - Vector::Constant(0.2);
        places.push_back(domain.low + t.cwiseProduct(domain.edges()));
    }
    return places;
}

template <int numbers, class Number>
void answer(const OctreeView<Number>& tree, const Point& x, double* out) {
    if (tree.leaves == nullptr) {
        answer_of_leaf<numbers>(tree, x.data(), out);
    } else {
        answer_of_corners<numbers>(tree, x.data(), out);
    }
}

template <class Number>
std::vector<Metric> answers(const OctreeArrays<Number>& octree, const std::vector<Point>& x) {
    std::vector<Metric> metrics;
    for (const Point& p : x) {
        double m[6];
        if (octree.numbers() == 1) {
            answer<1>(octree.view(), p, m);
            metrics.push_back(Metric::isotropic(m[0]));
        } else {
            answer<6>(octree.view(), p, m);
            metrics.push_back({m[0], m[1], m[2], m[3], m[4], m[5]});
        }
    }
    return metrics;
}

}  // namespace

TEST_CASE("octrees as arrays answer as octrees do, to the bit") {
    const std::string id = GENERATE("K_oL", "K_oLB", "K_oV");
    const bool tensors = GENERATE(false, true);
    const Box domain = GENERATE(Box{Point(-1, -1, -1), Point(1, 1.5, 1)},  //
                                Box{Point(1e6, 3, -0.1), Point(1e6 + 7, 4, 0.2)},
                                Box{Point(0, 0, 0.3), Point(2, 1, 0.3)});
    CAPTURE(id, tensors, domain.low.transpose());
    const auto space = editable(find_entry(tree_catalogue(), id)->make({.domain = domain}));
    space->insert(some_sources(domain, tensors));
    space->grade({});
    const std::vector<Point> x = some_places(domain);
    const auto check = [&](const ControlSpace& field, const auto& octree) {
        CHECK(octree.numbers() == (tensors ? 6 : 1));
        std::vector<Metric> expected(x.size());
        field.sample(x, expected);
        CHECK(answers(octree, x) == expected);
    };
    check(space->built(), OctreeArrays<double>(space->built()));
    const auto doubles = space->compact(Precision::doubles);
    const auto floats = space->compact(Precision::floats);
    check(*doubles, OctreeArrays<double>(*doubles));
    check(*floats, OctreeArrays<float>(*floats));
    check(*floats, OctreeArrays<float>(space->built()));
}

TEST_CASE("octrees of one leaf are arrays, too") {
    const Box domain{Point(0, 0, 0), Point(1, 2, 3)};
    const auto space = editable(find_entry(tree_catalogue(), "K_oV")->make({.domain = domain}));
    const std::vector<Point> x = some_places(domain);
    std::vector<Metric> expected(x.size());
    space->built().sample(x, expected);
    CHECK(answers(OctreeArrays<double>(space->built()), x) == expected);
}

TEST_CASE("other structures are no octrees") {
    const Box domain{Point(0, 0, 0), Point(1, 2, 3)};
    for (const char* id : {"K_L", "K_oLi"}) {
        const auto space = editable(find_entry(tree_catalogue(), id)->make({.domain = domain}));
        CHECK_THROWS_WITH(OctreeArrays<double>(space->built()), Contains(id) && Contains("K_oV"));
    }
}

}  // namespace controlspace::octree_arrays_test
