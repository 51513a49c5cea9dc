// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "controlspace/geometry/extent.h"
#include "controlspace/metric/blend.h"
#include "trees/topology/corners.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// From `low` to `high`; in a flat box the least positive number.
[[gnu::always_inline]] inline double divisible_edge(double low, double high) {
    constexpr double least = std::numeric_limits<double>::min();
    const double edge = high - low;
    return edge > least ? edge : least;
}

/// Where `x`, or the nearest place between, is from `low` to `high`: 0 to 1, and 0 in a flat box.
[[gnu::always_inline]] inline double fraction_between(double low, double high, double x) {
    x = x > low ? x : low;
    x = x < high ? x : high;
    return (x - low) / divisible_edge(low, high);
}

/// The weights of the corners of some boxes, for a place in each: `corner_weights` side by side, in
/// vectors.
template <std::size_t most>
class WeightsInBoxes {
public:
    /// The nearest place of the box to `x` is taken.
    void put(std::size_t i, const Box& box, const Point& x) {
        for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<Axis>(a);
            low_[a][i] = box.low[axis];
            high_[a][i] = box.high[axis];
            place_[a][i] = x[axis];
        }
    }
    /// Of the first `count` boxes.
    void weigh(std::size_t count) {
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t i = 0; i < count; ++i) {
                place_[a][i] = fraction_between(low_[a][i], high_[a][i], place_[a][i]);
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            const double x = place_[0][i], y = place_[1][i], z = place_[2][i];
            const double low_x = 1 - x, low_y = 1 - y, low_z = 1 - z;
            weights_[0][i] = low_x * low_y * low_z;
            weights_[1][i] = x * low_y * low_z;
            weights_[2][i] = low_x * y * low_z;
            weights_[3][i] = x * y * low_z;
            weights_[4][i] = low_x * low_y * z;
            weights_[5][i] = x * low_y * z;
            weights_[6][i] = low_x * y * z;
            weights_[7][i] = x * y * z;
        }
    }
    double operator()(std::size_t i, std::size_t corner) const { return weights_[corner][i]; }

private:
    using Numbers = std::array<double, most>;

    std::array<Numbers, 3> low_, high_, place_;
    std::array<Numbers, 8> weights_;
};

/// The metrics at a leaf's corners, of which it holds the numbers.
template <class M>
struct AtCorners {
    const Corners& corners;
    const M* metrics;

    const M& operator()(std::size_t corner) const { return metrics[corners[corner]]; }
    [[gnu::always_inline]] void prefetch() const {
        for (const NodeIndex node : corners) __builtin_prefetch(&metrics[node]);
    }
};

/// The metric at `x`, or the length where all are known to be isotropic, trilinear between the
/// corners of the leaf that holds it; `values` as below.
template <class Value, class Values>
Value trilinear_in_leaf(const Values& values, LeafIndex leaf, const Point& x) {
    const auto at_corners = values.at_corners(leaf);
    const Box box = values.box(leaf);
    std::array<std::array<double, 2>, 3> sides;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Axis>(a);
        const double high = fraction_between(box.low[axis], box.high[axis], x[axis]);
        sides[a] = {1 - high, high};
    }
    return blend<Value>(
        8, [&](std::size_t c) { return sides[0][c & 1] * sides[1][c >> 1 & 1] * sides[2][c >> 2]; },
        at_corners);
}

/// Metrics at `x`, or lengths where all are known to be isotropic, trilinear between the corners of
/// the leaves that hold them, for some places at a time, so that metrics are prefetched while
/// weights are computed. `values` provides box(leaf), prefetch_box(leaf), if it is worth it, and
/// at_corners(leaf), a function of a corner's number, with prefetch() where it reads from afar.
template <std::size_t at_a_time, class Values, class Value>
void trilinear_in_leaves(const Values& values, std::span<const LeafIndex> leaves,
                         std::span<const Point> x, std::span<Value> out) {
    WeightsInBoxes<at_a_time> weights;
    for (std::size_t first = 0; first < x.size(); first += at_a_time) {
        const std::size_t count = std::min(at_a_time, x.size() - first);
        if constexpr (requires { values.prefetch_box(leaves[0]); }) {
            for (std::size_t i = 0; i < count; ++i) values.prefetch_box(leaves[first + i]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const LeafIndex leaf = leaves[first + i];
            const auto at_corners = values.at_corners(leaf);
            if constexpr (requires { at_corners.prefetch(); }) at_corners.prefetch();
            weights.put(i, values.box(leaf), x[first + i]);
        }
        weights.weigh(count);
        for (std::size_t i = 0; i < count; ++i) {
            out[first + i] = blend<Value>(
                8, [&](std::size_t c) { return weights(i, c); },
                values.at_corners(leaves[first + i]));
        }
    }
}

template <class Values, class Value>
[[gnu::always_inline]] inline void trilinear_in_leaves(const Values& values,
                                                       std::span<const LeafIndex> leaves,
                                                       std::span<const Point> x,
                                                       std::span<Value> out) {
    constexpr std::size_t most = 32;  // what they read fits into the nearest cache
    if (x.size() == 1) {
        out[0] = trilinear_in_leaf<Value>(values, leaves[0], x[0]);
    } else {
        trilinear_in_leaves<most>(values, leaves, x, out);
    }
}

}  // namespace controlspace
