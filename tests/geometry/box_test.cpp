// SPDX-License-Identifier: Apache-2.0
#include "controlspace/geometry/box.h"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/geometry/extent.h"
#include "controlspace/geometry/subdivision.h"

namespace controlspace::box_test {

using Catch::Matchers::Contains;

TEST_CASE("a box is fit for a domain from 1e-50 to 1e50, and near enough to the origin") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    struct Interval {
        double low, high;
        const char* wrong;  // null: nothing
    };
    const auto c = GENERATE_COPY(
        Interval{-1, 1, nullptr}, Interval{0, 1e-50, nullptr}, Interval{-1e50, 1e50, nullptr},
        Interval{1e9, 1e9 + 1, nullptr}, Interval{0, 0, "no extent"}, Interval{1, 0, "no extent"},
        Interval{nan, 1, "no extent"}, Interval{0, nan, "no extent"}, Interval{0, inf, "beyond"},
        Interval{-inf, 0, "beyond"}, Interval{inf, inf, "no extent"}, Interval{0, 1e51, "beyond"},
        Interval{-1e308, 1e308, "beyond"}, Interval{0, 1e-300, "shorter"},
        Interval{1e16, 1e16 + 4, "too thin"}, Interval{-1e9 - 0.1, -1e9, "too thin"});
    CAPTURE(c.low, c.high);
    for (Axis a = 0; a < 3; ++a) {
        Box box{Point::Constant(-1), Point::Constant(1)};
        box.low[a] = c.low;
        box.high[a] = c.high;
        if (c.wrong == nullptr) {
            CHECK(require_volume(box) == box);
        } else {
            CHECK_THROWS_WITH(require_volume(box),
                              Contains(c.wrong) && Contains(std::string("along ") + "xyz"[a]));
        }
    }
}

TEST_CASE("a box may be flat across one axis, where the others have extent") {
    for (Axis a = 0; a < 3; ++a) {
        Box flat{Point(1, 2, 3), Point(2, 4, 6)};
        CHECK(!flat_axis(flat));
        CHECK(measure(flat) == 6);
        flat.high[a] = flat.low[a];
        CHECK(flat_axis(flat) == a);
        CHECK(require_extent(flat) == flat);
        CHECK_THROWS_WITH(require_volume(flat), Contains("no extent"));
        CHECK(measure(flat) == Approx(6 / Vector(1, 2, 3)[a]));
        CHECK(divisible_edges(flat)[a] == 1);
        CHECK(octants(flat).children() == 4);
        Box line = flat;
        line.high[(a + 1) % 3] = line.low[(a + 1) % 3];
        CHECK_THROWS_WITH(require_extent(line), Contains("no extent along two axes"));
        Box inverted = flat;
        inverted.high[(a + 1) % 3] = inverted.low[(a + 1) % 3] - 1;
        CHECK_THROWS_WITH(require_extent(inverted), Contains("no extent along"));
        Box far = flat;
        far.low[a] = far.high[a] = 1e51;
        CHECK_THROWS_WITH(require_extent(far), Contains("beyond"));
    }
}

TEST_CASE("the box around points has a volume, whatever their shape") {
    const std::vector<Point> points{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}};
    CHECK(bounding_box(points, 0.1) == Box{{-0.2, -0.2, -1.2}, {2.2, 1.2, 1.2}});
    CHECK(bounding_box({points.data(), 2}, 0) == Box{{0, -1, -1}, {2, 1, 1}});
    CHECK(bounding_box({points.data(), 1}, 0) == Box{Point::Constant(-0.5), Point::Constant(0.5)});
    CHECK_THROWS_AS(bounding_box({}, 0.1), InputError);
}

TEST_CASE("no point of a box is nearer than the nearest") {
    const Box box{Point(-3, 10, 7), Point(-1, 14, 7)};
    constexpr int n = 7;
    const auto lattice = [](const Box& in, int i) -> Point {
        const Vector t(i % n, i / n % n, i / (n * n));
        return in.low + (t / (n - 1)).cwiseProduct(in.edges());
    };
    const Box around{Point(-6, 4, 5), Point(2, 18, 9)};
    for (int i = 0; i < n * n * n; ++i) {
        const Point x = lattice(around, i);
        const Point nearest = nearest_in(box, x);
        REQUIRE(box.contains(nearest));
        if (box.contains(x)) CHECK(nearest == x);
        for (int k = 0; k < n * n; ++k) {
            CHECK((x - nearest).norm() <= (x - lattice(box, k)).norm() + 1e-12);
        }
    }
}

}  // namespace controlspace::box_test
