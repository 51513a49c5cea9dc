// SPDX-License-Identifier: Apache-2.0
// How the exact field behaves when the unit of length, the origin or the names of the axes change:
// in an oblong box far from the origin, with sources that have no symmetry.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "controlspace/measure/reference.h"
#include "metric/draw.h"

namespace controlspace::laws_test {
namespace {

constexpr double g = 1.25;
const Box box{Point(1000, -320, 64), Point(1024, -317, 65)};

// A point of the box, far nearer to its low corner than to others. Its coordinates are multiples of
// 2^-20: scaled by powers of two, or moved, they are exact.
Point place(Draw& draw) {
    Point p;
    for (Axis a = 0; a < 3; ++a) {
        const double t = std::pow(draw.uniform(0, 1), 2);
        p[a] = box.low[a] + std::round(t * box.edges()[a] * 0x1p20) * 0x1p-20;
    }
    return p;
}

struct Setup {
    std::vector<PointSource> sources;
    Metric largest = Metric::isotropic(8);
    std::vector<Point> x;

    explicit Setup(double anisotropy) {
        Draw draw(41);
        for (int i = 0; i < 600; ++i) {
            const double size = 0.01 * std::pow(50, draw.uniform(0, 1));
            sources.push_back({place(draw), anisotropy > 1 ? draw.metric(size, anisotropy)
                                                           : Metric::isotropic(size)});
        }
        for (int i = 0; i < 150; ++i) x.push_back(place(draw));
        for (int i = 0; i < 50; ++i) x.push_back(box.centre() + 40 * draw.vector());
    }
    std::vector<Metric> answers() const {
        std::vector<Metric> out(x.size());
        exact_reference(sources, g, largest, 0, IntersectionRule::in_turn)->sample(x, out);
        return out;
    }
};

}  // namespace

TEST_CASE("The exact field in an oblong box far from the origin is that of the oracle") {
    const double anisotropy = GENERATE(1.0, 4.0, 100.0);
    const Setup setup(anisotropy);
    std::vector<Metric> expected(setup.x.size());
    brute_force_reference(setup.sources, g, setup.largest)->sample(setup.x, expected);
    const std::vector<Metric> found = setup.answers();
    std::size_t governed = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        REQUIRE(difference(found[i], expected[i]) <= (anisotropy > 1 ? 1e-12 : 0));
        governed += found[i] != setup.largest ? 1u : 0u;
    }
    CHECK(governed > found.size() / 2);
}

TEST_CASE("Moved sources make a moved field, to the bit") {
    const double anisotropy = GENERATE(1.0, 4.0);
    const Setup setup(anisotropy);
    Setup moved = setup;
    const Vector away(-3072, 640, 0.5);
    for (PointSource& s : moved.sources) s.position += away;
    moved.x.resize(150);
    for (Point& p : moved.x) p += away;
    std::vector<Metric> expected = setup.answers();
    expected.resize(150);
    CHECK(moved.answers() == expected);
}

TEST_CASE("In a unit 32 times as short, the exact field is 32 times as long, to the bit") {
    const double anisotropy = GENERATE(1.0, 4.0);
    const Setup setup(anisotropy);
    Setup scaled = setup;
    for (PointSource& s : scaled.sources) s = {32 * s.position, 32.0 * s.metric};
    for (Point& p : scaled.x) p *= 32;
    scaled.largest = 32.0 * setup.largest;
    std::vector<Metric> expected = setup.answers();
    for (Metric& m : expected) m = 32.0 * m;
    CHECK(scaled.answers() == expected);
}

TEST_CASE("With axes renamed, the exact field has renamed axes") {
    const double anisotropy = GENERATE(1.0, 4.0);
    Eigen::Matrix3d turn;  // x to y, y to z, z to x
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    const Setup setup(anisotropy);
    Setup renamed = setup;
    for (PointSource& s : renamed.sources) s = {turn * s.position, rotated(s.metric, turn)};
    for (Point& p : renamed.x) p = turn * p;
    const std::vector<Metric> expected = setup.answers();
    const std::vector<Metric> found = renamed.answers();
    for (std::size_t i = 0; i < found.size(); ++i) {
        REQUIRE(difference(found[i], rotated(expected[i], turn)) <
                (anisotropy > 1 ? 1e-10 : 1e-14));
    }
}

}  // namespace controlspace::laws_test
