// SPDX-License-Identifier: Apache-2.0
#include "trees/adaptation/single_cones.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/sources/cone.h"

namespace controlspace::single_cones_test {
namespace {

constexpr double target = 0.1;
constexpr double ratio = 1.25;

class Random {
public:
    double between(double low, double high) {
        return std::uniform_real_distribution<>(low, high)(generator_);
    }
    Point place() { return {between(0, 1), between(0, 1), between(0, 1)}; }
    Metric disc(double anisotropy) {
        const Vector normal = (place() - Vector::Constant(0.5)).normalized();
        return layer_metric(normal, 0.2 / anisotropy, 0.2);
    }

private:
    std::mt19937_64 generator_{5};
};

Metric trilinear(const Box& box, const std::array<Metric, 8>& at_corners, const Point& x) {
    const Vector u = (x - box.low).cwiseQuotient(box.edges());
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int c = 0; c < 8; ++c) {
        double weight = 1;
        for (Axis a = 0; a < 3; ++a) weight *= (c >> a & 1) != 0 ? u[a] : 1 - u[a];
        sum += weight * at_corners[static_cast<std::size_t>(c)].matrix();
    }
    return Metric::from_matrix(sum);
}

Metric cone_at(const PointSource& source, const Point& x) {
    return cone_factor(source, ratio, x) * source.metric;
}

double beyond(const Metric& own, const Metric& cone) {
    return directional_nonconformity(own, intersection(own, cone));
}

}  // namespace

TEST_CASE("no metric that passes is longer than a cone anywhere in its box") {
    Random random;
    int quickly_passed = 0;
    int passed = 0;
    int found = 0;
    for (int k = 0; k < 300; ++k) {
        const double anisotropy = std::pow(10, random.between(0, 3));
        const PointSource source{random.place(), random.disc(anisotropy)};
        const Point low = random.place() - Vector::Constant(0.5);
        const Box box{low, low + 0.2 * random.place() + Vector::Constant(0.01)};
        std::array<Metric, 8> at_corners;
        const double most = random.between(1.05, 1.4);
        for (int c = 0; c < 8; ++c) {
            at_corners[static_cast<std::size_t>(c)] =
                random.between(0.8, most) * cone_at(source, corner(box, c));
        }
        const auto own = [&](const Point& x) { return trilinear(box, at_corners, x); };
        const SingleCones cones({&source, 1}, ratio, target);
        if (!cones.may_be_exceeded(0, box, at_corners)) {
            ++quickly_passed;
            REQUIRE(cones.at_nearest_place(0, box, own).worst == 0);
        }
        const Departure worst = cones.worst_in(box, at_corners, own);
        if (worst.worst > target) {
            ++found;
            REQUIRE(beyond(own(worst.where), cone_at(source, worst.where)) ==
                    Approx(worst.worst).epsilon(1e-9));
            continue;
        }
        ++passed;
        for (int i = 0; i < 300; ++i) {
            const Point x = box.low + box.edges().cwiseProduct(random.place());
            REQUIRE(beyond(own(x), cone_at(source, x)) <= target * (1 + 1e-9));
        }
    }
    CHECK(quickly_passed > 20);
    CHECK(passed > 50);
    CHECK(found > 50);
}

TEST_CASE("a cone is exceeded inside a box whose corners are within it") {
    const Metric metric = layer_metric(Vector(1, 2, 3).normalized(), 0.01, 0.1);
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    const PointSource source{Point(0.4, 0.6, 1.001), metric};
    const Metric own = 2 * metric;
    std::array<Metric, 8> at_corners;
    at_corners.fill(own);
    for (int c = 0; c < 8; ++c) REQUIRE(is_within(own, 1, cone_at(source, corner(box, c))));
    const Departure worst =
        SingleCones({&source, 1}, ratio, target).worst_in(box, at_corners, [&](const Point&) {
            return own;
        });
    CHECK(worst.worst > target);
    CHECK((worst.where - source.position).norm() < 0.01);
    const SingleCones far({&source, 1}, ratio, target);
    const Box elsewhere{Point(0, 0, -2), Point(1, 1, -1)};
    CHECK(far.worst_in(elsewhere, at_corners, [&](const Point&) { return own; }).worst == 0);
}

TEST_CASE("the nearest place of a box is where the cone is smallest") {
    Random random;
    for (int k = 0; k < 100; ++k) {
        const PointSource source{2 * random.place(), random.disc(30)};
        const Box box{Point(0, 0, 0), Point(0.3, 1, 0.6)};
        Point asked = Point::Zero();
        const auto long_everywhere = [&](const Point& x) {
            asked = x;
            return Metric::isotropic(10);
        };
        const Departure at =
            SingleCones({&source, 1}, ratio, target).at_nearest_place(0, box, long_everywhere);
        REQUIRE(at.worst > target);
        REQUIRE(box.contains(asked));
        const double least = metric_length(source.metric, asked - source.position);
        for (int i = 0; i < 400; ++i) {
            // Inside, and in faces, edges and corners.
            Point x = random.place();
            for (Axis a = 0; a < 3; ++a) {
                if (random.between(0, 1) < 0.6) x[a] = std::round(x[a]);
            }
            x = box.edges().cwiseProduct(x);
            REQUIRE(metric_length(source.metric, x - source.position) >= least * (1 - 1e-9));
        }
    }
}

TEST_CASE("places around the tip of a cone are in boxes that are large beside their distance") {
    const Metric metric = layer_metric(Vector(1, 2, 3).normalized(), 0.01, 0.1);
    const PointSource source{Point(0.4, 0.6, 1.001), metric};
    const SingleCones cones({&source, 1}, ratio, target);
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    std::vector<Point> places;
    cones.append_around_tips(box, 3, places);
    CHECK(places.size() >= 12);
    int on_face = 0, near = 0;
    for (const Point& x : places) {
        REQUIRE(box.contains(x));
        on_face += x.z() == 1 ? 1 : 0;
        near += metric_length(metric, x - source.position) < 2 ? 1 : 0;
    }
    CHECK(on_face > 0);
    CHECK(on_face < static_cast<int>(places.size()));
    CHECK(near > 0);

    std::vector<Point> none;
    cones.append_around_tips({Point(0, 0, -2), Point(1, 1, -1)}, 3, none);
    cones.append_around_tips({Point(0.39, 0.59, 0.94), Point(0.41, 0.61, 0.96)}, 3, none);
    CHECK(none.empty());
}

TEST_CASE(
    "places around the tip of a cone are there once, and on its edges and corners if wanted") {
    // Steps as long as the box end at its corners, on its edges and on its faces.
    const PointSource source{Point(0.4, 0.6, 1.001), Metric::isotropic(0.5)};
    const SingleCones cones({&source, 1}, ratio, target);
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    const auto faces_at = [](const Point& x) {
        return ((x.array() == 0) || (x.array() == 1)).count();
    };
    std::vector<Point> all;
    cones.append_around_tips(box, 3, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK(std::count(all.begin(), all.end(), all[i]) == 1);
    }
    for (const std::ptrdiff_t most_faces : {1, 2}) {
        std::vector<Point> places;
        cones.append_around_tips(box, most_faces, places);
        std::vector<Point> expected;
        std::copy_if(all.begin(), all.end(), std::back_inserter(expected),
                     [&](const Point& x) { return faces_at(x) <= most_faces; });
        CHECK(places == expected);
        CHECK(places.size() < all.size());
        CHECK_FALSE(places.empty());
    }
}

TEST_CASE("metrics beyond a cone are in contact with it, if only a little") {
    const PointSource source{Point(0.4, 0.6, 1.1), Metric::isotropic(0.2)};
    const Box box{Point(0, 0, 0), Point(1, 1, 1)};
    const SingleCones cones({&source, 1}, ratio, target);
    const Metric at_nearest = cone_at(source, Point(0.4, 0.6, 1));
    for (const double factor : {0.98, 1.02}) {
        std::vector<Point> contacts;
        const Departure departure = cones.at_nearest_place(
            0, box, [&](const Point&) { return factor * at_nearest; }, &contacts);
        CHECK(departure.worst == 0);
        CHECK(contacts.size() == (factor > 1 ? 1 : 0));
    }
}

}  // namespace controlspace::single_cones_test
