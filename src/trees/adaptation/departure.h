// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <tuple>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// The largest sampled non-conformity of a cell to a field.
struct Departure {
    double worst = 0;  ///< δ, or a bound: lower above the target, upper below 3/4 of it
    Point where = Point::Zero();
    std::array<double, 3> along{};  ///< how much speaks for a cut across each axis

    void take(double delta, const Point& x) {
        if (!(delta > worst)) return;
        worst = delta;
        where = x;
    }
    /// The same of all that are given, whatever their order.
    void take(const Departure& other) {
        const auto key = [](const Departure& d) {
            return std::tuple(d.worst, d.where.x(), d.where.y(), d.where.z());
        };
        if (!(key(*this) < key(other))) return;
        worst = other.worst;
        where = other.where;
    }
};

}  // namespace controlspace
