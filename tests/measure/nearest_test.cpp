// SPDX-License-Identifier: Apache-2.0
// Nearest points against a search through all.
#include "measure/nearest.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "geometry/random_fractions.h"

namespace controlspace::nearest_test {

TEST_CASE("the nearest points are those that a search through all finds") {
    RandomFractions fraction(7);
    std::vector<Point> points;
    for (int i = 0; i < 500; ++i) points.emplace_back(fraction(), 0.1 * fraction(), fraction());
    for (int i = 0; i < 20; ++i) points.push_back(points.front());  // they are no neighbours
    constexpr std::size_t most = 5;
    const NodeGraph graph = nearest_neighbours(points, most);
    REQUIRE(graph.size() == points.size());
    for (NodeIndex i = 0; i < points.size(); ++i) {
        std::vector<double> all;
        for (const Point& p : points) {
            if (p != points[i]) all.push_back((p - points[i]).norm());
        }
        std::sort(all.begin(), all.end());
        std::vector<double> found;
        graph.for_each_link(i, [&](NodeIndex, const Vector& v) { found.push_back(v.norm()); });
        REQUIRE(found.size() == most);
        REQUIRE(std::equal(found.begin(), found.end(), all.begin(),
                           [](double a, double b) { return a == Approx(b); }));
    }
}

TEST_CASE("fewer points than asked for, or all in one place") {
    const std::vector<Point> three{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
    const NodeGraph graph = nearest_neighbours(three, 6);
    CHECK(graph.neighbours == std::vector<NodeIndex>{1, 2, 0, 2, 1, 0});
    CHECK(nearest_neighbours(std::vector<Point>(4, Point::Zero()), 6).neighbours.empty());
    CHECK(nearest_neighbours({}, 6).size() == 0);
}

}  // namespace controlspace::nearest_test
