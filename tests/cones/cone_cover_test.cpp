// SPDX-License-Identifier: Apache-2.0
#include "cones/cone_cover.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <vector>

#include "cones/cone_field.h"
#include "cones/own_growths.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "metric/draw.h"

namespace controlspace::cone_cover_test {
namespace {

constexpr double g = 1.25;
constexpr double cap = 0.6;
const Metric wide = Metric::isotropic(cap);

std::vector<PointSource> scattered(Draw& draw, double least) {
    std::vector<PointSource> sources;
    for (int i = 0; i < 1500; ++i) {
        const double h = least * std::pow(0.8 / least, draw.uniform(0, 1));
        sources.push_back({draw.vector(), Metric::isotropic(h)});
        if (i % 10 == 0) sources.push_back(sources.back());
    }
    return sources;
}

template <class Numbers>
double smallest_at(const Point& p, const std::vector<PointSource>& sources, const Numbers& of) {
    double smallest = cap;
    for (const auto i : of) {
        const PointSource& s = sources[i];
        smallest =
            std::min(smallest, s.metric.xx + (cone_growth(s, g) - 1) * (p - s.position).norm());
    }
    return smallest;
}

Point place_in(Draw& draw, const Box& box) {
    // Corners and faces as often as places inside.
    const auto t = [&] { return std::clamp(draw.uniform(-0.5, 1.5), 0.0, 1.0); };
    return box.low + Vector(t(), t(), t()).cwiseProduct(box.edges());
}

}  // namespace

TEST_CASE("sources that cover a box make the exact field there, up to the tolerance") {
    Draw draw(1);
    for (const auto& sources :
         {scattered(draw, 0.02), scattered(draw, 1e-6), sample_sphere({.h = 0.1}),
          with_own_growths(scattered(draw, 0.02), draw),
          with_own_growths(sample_sphere({.h = 0.1}), draw)}) {
        const ConeField field(sources, g, wide);
        std::vector<std::uint32_t> all(sources.size());
        std::iota(all.begin(), all.end(), 0u);
        IsotropicCones::Hint hint = 0;
        ConeCover cover;
        int covered = 0, refused = 0;
        double most = 0;
        for (int k = 0; k < 300; ++k) {
            const Point centre = draw.vector();
            const Vector half = 0.5 * std::pow(10, draw.uniform(-3, 0.3)) *
                                Vector(1, draw.uniform(0.3, 1), draw.uniform(0.3, 1));
            const Box box{centre - half, centre + half};
            const double tolerance = std::pow(10, draw.uniform(-2, -0.3));
            if (!field.isotropic().cover(box, tolerance, cover, hint)) {
                ++refused;
                continue;
            }
            ++covered;
            for (int i = 0; i < 40; ++i) {
                const Point p = place_in(draw, box);
                const double exact = smallest_at(p, sources, all);
                const double own = smallest_at(p, sources, cover.sources());
                REQUIRE(own <= (1 + tolerance) * exact * (1 + 1e-12));
                most = std::max(most, (own / exact - 1) / tolerance);
            }
        }
        CHECK(covered > 100);
        CHECK(refused > 10);
        CHECK(most > 0.3);  // no closer than it has to be
    }
}

TEST_CASE("a cover takes no more sources than it needs") {
    const Box box{Point::Constant(-0.1), Point::Constant(0.1)};
    IsotropicCones::Hint hint = 0;
    ConeCover cover;
    const auto count = [&](const std::vector<PointSource>& sources) {
        const ConeField field(sources, g, wide);
        REQUIRE(field.isotropic().cover(box, 0.05, cover, hint));
        return cover.sources().size();
    };
    const PointSource here{Point(0.02, 0, 0), Metric::isotropic(0.1)};
    CHECK(count({}) == 0);
    CHECK(count({here}) == 1);
    CHECK(count({here, {Point(-0.02, 0, 0), Metric::isotropic(0.3)}}) == 1);
    CHECK(count({here, {Point(0.9, 0, 0), Metric::isotropic(0.1)}}) == 1);
    CHECK(count({here, {Point(-0.09, 0, 0), Metric::isotropic(0.1)}}) == 2);
    CHECK(count({{Point(0.9, 0.9, 0.9), Metric::isotropic(0.5)}}) == 0);  // beyond the cap
}

TEST_CASE("a box that more sources govern than there is room for is not covered") {
    std::vector<PointSource> sources;
    for (int i = 0; i < 27; ++i) {
        sources.push_back({Point(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1), Metric::isotropic(0.01)});
    }
    const ConeField field(sources, g, wide);
    IsotropicCones::Hint hint = 0;
    ConeCover cover;
    CHECK_FALSE(
        field.isotropic().cover({Point::Constant(-1), Point::Constant(1)}, 0.1, cover, hint));
    CHECK(cover.sources().size() <= ConeCover::room);
    CHECK(field.isotropic().cover({Point::Constant(0), Point::Constant(1)}, 0.1, cover, hint));
    CHECK(cover.sources().size() == 8);
}

}  // namespace controlspace::cone_cover_test
