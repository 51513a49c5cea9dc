// SPDX-License-Identifier: Apache-2.0
#include "trees/values/quadratic_values.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "editable_space.h"
#include "trees/topology/adjacency.h"
#include "trees/values/triquadratic.h"

namespace controlspace::quadratic_values_test {
namespace {

const Box domain{Point::Constant(-1), Point::Constant(1)};
constexpr double ratio = 1.25;

std::unique_ptr<EditableSpace> quadratic(SplitRule split) {
    const CatalogueEntry& entry = tree_named("K_Li");
    REQUIRE(entry.id == "K_Li");
    return editable(entry.make({.domain = domain, .split = split, .ratio = ratio}));
}

// The metric of the leaf that holds `x`.
Metric own_at(const ControlSpace& space, const Point& x) {
    return sample_at(space, space.cell_at(x).value().centre());
}

// By what is known of single leaves alone, with tensors.
Metric by_leaves(const ControlSpace& space, const Point& place) {
    const Box box = space.cell_at(place).value();
    const Point x = place.cwiseMax(box.low).cwiseMin(box.high);
    const Metric own = own_at(space, x);
    std::array<Metric, 6> across;
    for (int face = 0; face < 6; ++face) {
        Point y = x;
        const bool is_inside = step_across(space.domain(), box, face, y);
        across[static_cast<std::size_t>(face)] = is_inside ? own_at(space, y) : own;
    }
    const Vector v = x - box.centre();
    const Vector t = 2 * v.cwiseQuotient(box.edges());
    return triquadratic(own, across, t, 1 + (ratio - 1) * metric_length(own, v));
}

// Random places, some outside, and some on planes of cuts.
std::vector<Point> places() {
    std::vector<Point> x = random_points({Point::Constant(-1.1), Point::Constant(1.1)}, 2000, 5);
    for (std::size_t i = 0; i < x.size(); i += 4) {
        const auto a = static_cast<Axis>(i / 4 % 3);
        x[i][a] = std::round(16 * x[i][a]) / 16;
    }
    return x;
}

void check_answers(const ControlSpace& space) {
    const std::vector<Point> x = places();
    std::vector<Metric> batch(x.size());
    space.sample(x, batch);
    for (std::size_t i = 0; i < x.size(); ++i) {
        REQUIRE(batch[i] == by_leaves(space, x[i]));
        REQUIRE(batch[i] == sample_at(space, x[i]));
    }
}

}  // namespace

TEST_CASE("K_Li interpolates between the leaf and its neighbours, however they are found") {
    for (const double s_n : {1.0, 0.2}) {
        const std::vector<PointSource> sources =
            sample_sphere({.h = 0.2, .s_a = 3, .s_n = s_n, .rho = 1});
        for (const SplitRule split : {SplitRule::middle, SplitRule::golden, SplitRule::metric}) {
            CAPTURE(s_n, static_cast<int>(split));
            const auto space = quadratic(split);
            for (const PointSource& source : sources) space->insert(source);
            check_answers(*space);
            space->grade({.ratio = ratio});
            check_answers(*space);
            check_answers(*space->compact(Precision::doubles));
            // Leaves are split once more; the first source is thin, the second is not.
            for (const double thin : {0.2, 1.0}) {
                const Point p = thin < 1 ? Point(0.3, -0.2, 0.9) : Point(-0.7, 0.1, 0.1);
                space->insert({p, {0.01, 0.01, 0.01 * thin, 0, 0, 0}});
                check_answers(*space);
            }
            space->insert(sources);
            check_answers(*space);
        }
    }
}

TEST_CASE("a source at a leaf's face is met by K_Li, before gradation and after") {
    // Next to the cut planes in the middle of the domain, and in its corner.
    for (const Point& p : {Point(0, 0, 0), Point(1e-9, 0.3, -0.5), Point(-1, -1, -1)}) {
        const PointSource source{p, Metric::isotropic(0.01)};
        const Box domain{Point::Constant(-1), Point::Constant(1)};
        const auto space = editable(tree_named("K_Li").make({.domain = domain}));
        space->insert(source);
        // Along a leaf's half diagonal, at most sqrt(3) / 2 of its size, sizes grow by 0.25.
        const double growth = 0.25 * std::sqrt(0.75);
        CHECK(sample_at(*space, p).xx <= 0.01 * (1 + growth));
        space->grade({.schedule = GradationSchedule::queue, .ratio = 1.25});
        CHECK(sample_at(*space, p).xx <= 0.01 * (1 + growth));
        // From the source to the centre, where the field is exact, and back.
        space->grade({.ratio = 1.25});
        CHECK(sample_at(*space, p).xx <= 0.01 * (1 + 2 * growth));
    }
}

TEST_CASE(
    "quadratic leaves keep to the ratio that they are graded with, not that of their options") {
    const Box domain{Point::Constant(-1), Point::Constant(1)};
    const CatalogueEntry& entry = *find_entry(tree_catalogue(), GENERATE("K_Li", "K_oLi"));
    const auto space = editable(entry.make({.domain = domain, .ratio = 2}));
    space->insert(PointSource{Point(0.3, 0.2, 0.1), Metric::isotropic(0.1)});
    space->insert(PointSource{Point(-0.4, 0.2, -0.1), Metric::isotropic(0.03)});
    constexpr double g = 1.05;
    space->grade({.ratio = g});
    for (const Point& x : cell_centres(domain, 21)) {
        const Point centre = space->cell_at(x)->centre();
        const double own = sample_at(*space, centre).xx;
        REQUIRE(sample_at(*space, x).xx <= own + (g - 1) * (x - centre).norm() + 1e-12);
    }
}

TEST_CASE("no axis of a quadratic leaf falls below half of its own, beside whatever neighbour") {
    const Metric own = Metric{1, 1.5, 2, 0, 0, 0};
    for (std::size_t face = 0; face < 6; ++face) {
        // A neighbour a hundred times as long along one axis, away from which quadratic functions
        // undershoot.
        for (std::size_t along = 0; along < 3; ++along) {
            std::array<Metric, 6> across;
            across.fill(own);
            double* const lengths[] = {&across[face].xx, &across[face].yy, &across[face].zz};
            *lengths[along] *= 100;
            Vector t = Vector::Zero();
            t[static_cast<Axis>(face / 2)] = face % 2 == 0 ? 0.5 : -0.5;
            const Metric m = triquadratic(own, across, t, 10);
            CAPTURE(face, along);
            const double held[] = {m.xx / own.xx, m.yy / own.yy, m.zz / own.zz};
            CHECK(held[along] == Approx(0.5));
            CHECK(std::ranges::min(held) >= 0.5 * (1 - 1e-12));
        }
    }
}

TEST_CASE("the published interpolation adds the corners' trilinear part at a wrong place") {
    // A field that is linear across faces: own 2, low faces 1, high faces 3 along x.
    const auto value = [](const Vector& k) {
        const auto weights = published_triquadratic_weights(k);
        const std::array<double, 7> metrics{1, 3, 2, 2, 2, 2, 2};
        double sum = 0;
        double of_weights = 0;
        for (std::size_t i = 0; i < 7; ++i) {
            sum += weights[i] * metrics[i];
            of_weights += weights[i];
        }
        CHECK(of_weights == Approx(1).epsilon(1e-14));
        return sum;
    };
    // Corners are 2 -+ 1/6 there; Tri(t) - Tri(k) = (t - k) / 6 with t = (k + 1) / 2.
    const auto right = [](const Vector& k) {
        const auto weights = triquadratic_weights(k);
        return weights[0] + 3 * weights[1] + 2 * (1 - weights[0] - weights[1]);
    };
    for (const Vector& k : {Vector(0, 0, 0), Vector(-1, -1, -1), Vector(0.3, -0.7, 0.2)}) {
        CHECK(value(k) - right(k) == Approx((0.5 * (k.x() + 1) - k.x()) / 6).margin(1e-14));
    }
    CHECK(value(Vector(1, 1, 1)) == Approx(right(Vector(1, 1, 1))));
}

}  // namespace controlspace::quadratic_values_test
