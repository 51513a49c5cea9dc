// SPDX-License-Identifier: Apache-2.0
#include "cones/trilinear_lengths.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "cones/isotropic_cones.h"
#include "controlspace/measure/access_time.h"

namespace controlspace::trilinear_lengths_test {
namespace {

Box domain_at(const Point& origin) { return {origin + Point(-1, 2, 0.5), origin + Point(1, 3, 4)}; }

struct Scene {
    std::vector<PointSource> sources;
    TrilinearLengths lengths;
    double g = 1;
    double cap = 0;

    double field(const Point& x) const {
        double least = cap;
        for (const PointSource& s : sources) {
            least = std::min(least, s.metric.xx + (g - 1) * (x - s.position).norm());
        }
        return least;
    }
    // By how much lengths at x are longer or shorter than the field.
    double ratio(const Point& x) const {
        const double t = lengths.at_place(x) / field(x);
        return std::max(t, 1 / t);
    }
};

// Lengths near those of the field at the corners; sources in the box, and outside of it.
Scene random_scene(std::mt19937_64& random) {
    std::uniform_real_distribution<double> share(0, 1);
    const Box domain = domain_at(share(random) < 0.2 ? Point(1e6, -3e6, 2e5) : Point::Zero());
    Scene scene;
    const double kind = share(random);
    scene.g = kind < 0.5 ? 1.25 : kind < 0.6 ? 1 : 1 + 4 * share(random);
    scene.cap = share(random) < 0.3 ? 0.5 : 10;
    const auto count = static_cast<std::size_t>(1 + 60 * std::pow(share(random), 3));
    for (const Point& x : random_points(domain, count, random())) {
        scene.sources.push_back({x, Metric::isotropic(0.05 + 0.3 * share(random))});
    }
    const Vector edges = 0.3 * share(random) *
                         domain.edges().cwiseProduct(
                             Vector(0.1 + share(random), 0.1 + share(random), 0.1 + share(random)));
    const Point near = share(random) < 0.5 ? scene.sources[0].position : domain.centre();
    scene.lengths.box.low = near - edges * share(random);
    scene.lengths.box.high = scene.lengths.box.low + edges;
    for (int c = 0; c < 8; ++c) {
        scene.lengths.at[static_cast<std::size_t>(c)] =
            scene.field(corner(scene.lengths.box, c)) * (0.98 + 0.04 * share(random));
    }
    return scene;
}

}  // namespace

TEST_CASE("trilinear lengths: halves have the same, and none is steeper than their slope") {
    std::mt19937_64 random(5);
    for (int k = 0; k < 50; ++k) {
        const TrilinearLengths lengths = random_scene(random).lengths;
        const auto [low, high] = lengths.halves();
        CHECK(low.box.low == lengths.box.low);
        CHECK(high.box.high == lengths.box.high);
        for (const TrilinearLengths& half : {low, high}) {
            const std::vector<Point> x = random_points(half.box, 20, random());
            for (std::size_t i = 1; i < x.size(); ++i) {
                CHECK(half.at_place(x[i]) == Approx(lengths.at_place(x[i])));
                const double rise = half.at_place(x[i]) - half.at_place(x[i - 1]);
                CHECK(std::abs(rise) <= lengths.slope() * (x[i] - x[i - 1]).norm() * (1 + 1e-9));
            }
        }
    }
}

TEST_CASE("lengths that are shown to follow isotropic cones do so everywhere, others are found") {
    std::mt19937_64 random(17);
    int proved = 0, refuted = 0, unknown = 0;
    for (int k = 0; k < 400; ++k) {
        CAPTURE(k);
        const Scene scene = random_scene(random);
        const IsotropicCones cones(columns_of(scene.sources), scene.g, scene.cap);
        // Brute force, with the places next to the sources, where the field has its minima.
        const Box& box = scene.lengths.box;
        std::vector<Point> x = random_points(box, 2000, random());
        for (const PointSource& s : scene.sources) {
            x.push_back(s.position.cwiseMax(box.low).cwiseMin(box.high));
        }
        double worst = 1;
        for (const Point& p : x) worst = std::max(worst, scene.ratio(p));
        for (const double factor :
             {1 + 0.5 * (worst - 1), 1 + 0.999 * (worst - 1), 1 + 1.5 * (worst - 1), 3 * worst}) {
            CAPTURE(factor, worst);
            IsotropicCones::Hint hint = 0;
            const auto doubt = cones.doubt_of(scene.lengths, factor, hint);
            if (!doubt) {
                ++proved;
                CHECK(worst <= factor);
            } else if (doubt->is_certain) {
                ++refuted;
                CHECK(box.contains(doubt->where));
                // Far from the origin places are rounded.
                const double rounding = 1e-12 * box.high.cwiseAbs().maxCoeff();
                CHECK(scene.ratio(doubt->where) > 1 + (1 - 1e-8) * (factor - 1) - rounding);
            } else {
                ++unknown;
            }
            // Two of the factors are well above the worst.
            if (factor >= 1 + 1.4 * (worst - 1)) CHECK_FALSE((doubt && !doubt->is_certain));
        }
    }
    CHECK(proved >= 700);
    CHECK(refuted >= 700);
    CHECK(unknown <= 120);  // nearly all at 0.999 of the worst
}

TEST_CASE("without sources lengths are compared with the largest") {
    const IsotropicCones cones(SourceColumns(), 1.25, 2);
    IsotropicCones::Hint hint = 0;
    TrilinearLengths lengths{domain_at(Point::Zero()), {}};
    lengths.at.fill(2);
    CHECK_FALSE(cones.doubt_of(lengths, 1.1, hint));
    lengths.at.fill(1.5);
    const auto doubt = cones.doubt_of(lengths, 1.1, hint);
    REQUIRE(doubt);
    CHECK(doubt->is_certain);
}

TEST_CASE("what rounding hides is not shown") {
    const PointSource source{Point(0, 2.5, 2), Metric::isotropic(0.1)};
    const IsotropicCones cones(columns_of({&source, 1}), 1.25, 10);
    IsotropicCones::Hint hint = 0;
    const Box box{Point(0.5, 2.5, 2), Point(0.5 + 1e-9, 2.5 + 1e-9, 2 + 1e-9)};
    TrilinearLengths lengths{box, {}};
    for (int c = 0; c < 8; ++c) {
        lengths.at[static_cast<std::size_t>(c)] = cones.smallest_length(corner(box, c), hint);
    }
    CHECK_FALSE(cones.doubt_of(lengths, 1 + 1e-6, hint));
    const auto doubt = cones.doubt_of(lengths, 1 + 1e-15, hint);
    REQUIRE(doubt);
    CHECK_FALSE(doubt->is_certain);
}

}  // namespace controlspace::trilinear_lengths_test
