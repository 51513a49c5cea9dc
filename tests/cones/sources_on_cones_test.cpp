// SPDX-License-Identifier: Apache-2.0
// A graded mesh read back as sources: all lie on, or nearly on, the cones of some.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "cones/isotropic_cones.h"
#include "controlspace/sources/cone.h"
#include "controlspace/sources/source_columns.h"
#include "metric/draw.h"

namespace controlspace::sources_on_cones_test {
namespace {

constexpr double g = 1.25;
constexpr double cap = 2;

std::vector<PointSource> tips(Draw& draw) {
    std::vector<PointSource> tips;
    for (int k = 0; k < 10; ++k) {
        tips.push_back(
            {draw.vector(), Metric::isotropic(0.005 * std::pow(10, draw.uniform(0, 1)))});
    }
    return tips;
}

double length_of(const std::vector<PointSource>& sources, const Point& x) {
    double length = cap;
    for (const PointSource& source : sources) {
        length = std::min(length, cone_factor(source, g, x) * source.metric.xx);
    }
    return length;
}

// At random places, with the lengths of the field of these cones.
std::vector<PointSource> on_cones(const std::vector<PointSource>& of, Draw& draw, int n) {
    std::vector<PointSource> sources;
    for (int i = 0; i < n; ++i) {
        const Point x = draw.vector();
        sources.push_back({x, Metric::isotropic(length_of(of, x))});
    }
    return sources;
}

IsotropicCones cones_of(const std::vector<PointSource>& sources, double longer = 1) {
    return {columns_of(std::span(sources)), g, cap, longer};
}

}  // namespace

TEST_CASE("Sources within rounding of others' cones are left out, and change lengths no more") {
    Draw draw(1);
    const std::vector<PointSource> few = tips(draw);
    std::vector<PointSource> sources = on_cones(few, draw, 16000);
    sources.insert(sources.end(), few.begin(), few.end());
    const IsotropicCones cones = cones_of(sources);
    CHECK(sources.size() - cones.dropped() <= 100);
    CHECK(cones.longer() == 1);
    IsotropicCones::Hint hint = 0;
    for (int i = 0; i < 300; ++i) {
        const Point x = draw.vector();
        const double exact = length_of(sources, x);
        REQUIRE(std::abs(cones.smallest_length(x, hint) / exact - 1) < 1e-14);
    }
}

TEST_CASE("To find that no source is on another's cone takes visits in proportion to sources") {
    Draw draw(2);
    const std::vector<PointSource> few = tips(draw);
    for (const int n : {16000, 128000}) {
        const std::vector<PointSource> sources = on_cones(few, draw, n);
        const IsotropicCones cones = cones_of(sources);
        CAPTURE(n, cones.dropped());
        CHECK(cones.visits() <= 32 * sources.size());
        IsotropicCones::Hint hint = 0;
        for (int i = 0; i < 100; ++i) {
            const Point x = draw.vector();
            REQUIRE(cones.smallest_length(x, hint) == length_of(sources, x));
        }
    }
}

TEST_CASE("Thinned sources give lengths that are longer by the factor allowed at most") {
    Draw draw(3);
    const std::vector<PointSource> few = tips(draw);
    std::vector<PointSource> sources = on_cones(few, draw, 16000);
    for (std::size_t i = 0; i < sources.size(); i += 3) sources[i].growth = draw.uniform(1.2, 2);
    const auto length_at = [&](const Point& x) {
        double length = cap;
        for (const PointSource& source : sources) {
            length = std::min(length, cone_factor(source, g, x) * source.metric.xx);
        }
        return length;
    };
    for (const double longer : {1.005, 1.02}) {
        const IsotropicCones cones = cones_of(sources, longer);
        CAPTURE(longer, cones.dropped());
        REQUIRE(cones.longer() == longer);
        CHECK(cones.dropped() > sources.size() / 2);
        IsotropicCones::Hint hint = 0;
        double most = 1;
        for (int i = 0; i < 1000; ++i) {
            const Point x =
                i % 2 == 0 ? draw.vector() : sources[static_cast<std::size_t>(16 * i)].position;
            const double exact = length_at(x);
            const double length = cones.smallest_length(x, hint);
            REQUIRE(length >= exact * (1 - 1e-14));
            most = std::max(most, length / exact);
        }
        CHECK(most <= longer * (1 + 1e-14));
        CHECK(most > 1 + 0.5 * (longer - 1));
    }
}

TEST_CASE("Sources that are searched quickly are thinned by no factor") {
    Draw draw(4);
    std::vector<PointSource> sources;
    for (int i = 0; i < 10000; ++i) {
        sources.push_back({draw.vector().normalized(), Metric::isotropic(0.05)});
    }
    const IsotropicCones cones = cones_of(sources, 1.02);
    CHECK(cones.longer() == 1);
    CHECK(cones.dropped() == 0);
}

}  // namespace controlspace::sources_on_cones_test
