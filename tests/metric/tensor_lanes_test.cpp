// SPDX-License-Identifier: Apache-2.0
#include "metric/tensor_lanes.h"

#include <catch2/catch.hpp>

#include "controlspace/metric/intersection.h"
#include "metric/draw.h"

namespace controlspace::tensor_lanes_test {
namespace {

TensorLanes metrics(Draw& draw, double anisotropy) {
    TensorLanes lanes;
    for (int lane = 0; lane < lane_count; ++lane) lanes.set(lane, draw.metric(1, anisotropy));
    return lanes;
}

}  // namespace

TEST_CASE("Lanes compute what single tensors do") {
    const double anisotropy = GENERATE(1.1, 10.0, 1e6);
    Draw draw(1);
    for (int round = 0; round < 500; ++round) {
        const TensorLanes m = metrics(draw, anisotropy);
        VectorLanes v;
        for (int lane = 0; lane < lane_count; ++lane) v.set(lane, draw.vector());
        const Point p = draw.vector();
        const VectorLanes to_p = displacements(v, p);
        const Lanes lengths = metric_lengths(m, to_p);
        const Lanes products = lengths_of_products(m, v);
        const TensorLanes squares = square(m);
        for (int lane = 0; lane < lane_count; ++lane) {
            REQUIRE(to_p[lane] == p - v[lane]);
            REQUIRE(lengths[lane] == metric_length(m[lane], p - v[lane]));
            REQUIRE(products[lane] == Approx((m[lane].matrix() * v[lane]).norm()).epsilon(1e-12));
            REQUIRE(squares[lane] == square(m[lane]));
        }
    }
}

TEST_CASE("There is room below where a tensor lies within others, and never else") {
    Draw draw(2);
    int within = 0;
    for (int round = 0; round < 500; ++round) {
        const Metric a = draw.metric(1, 3);
        const TensorLanes b = metrics(draw, 3);
        const Lanes factors = Lanes::Constant(2.5);
        const Pivots room = room_below(square(a), factors.square(), square(b));
        for (int lane = 0; lane < lane_count; ++lane) {
            REQUIRE(room.are_positive(lane) == (growth(a, 2.5 * b[lane]) < 1));
            within += room.are_positive(lane) ? 1 : 0;
        }
    }
    CHECK(within > 1000);
    CHECK(within < 3000);
    // Equal, and what is no number.
    const TensorLanes one;
    CHECK_FALSE(room_below(Metric{}, Lanes::Ones(), one).are_positive(0));
    CHECK_FALSE(room_below(Metric{}, Lanes::Constant(std::nan("")), one).are_positive(0));
}

}  // namespace controlspace::tensor_lanes_test
