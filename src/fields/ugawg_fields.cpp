// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/ugawg_fields.h"

#include <algorithm>
#include <cmath>

#include "controlspace/fields/formula_field.h"

namespace controlspace {

namespace {

constexpr double finest = 0.001;
constexpr double coarsest = 0.1;

// Across the layer at 0.5.
double length_across(double coordinate) {
    return finest + 2 * (coarsest - finest) * std::abs(coordinate - 0.5);
}

Metric cylindrical_metric(const Point& p, double r, double h_r, double h_t) {
    // On the axis, where no direction is radial, h_r and h_t are the same.
    const double c = r > 0 ? p.x() / r : 1;
    const double s = r > 0 ? p.y() / r : 0;
    return {
        h_r * c * c + h_t * s * s, h_r * s * s + h_t * c * c, coarsest, (h_r - h_t) * c * s, 0, 0};
}

template <class Formula>
AnalyticField in_unit_cube(Formula formula) {
    const Box unit_cube{Point::Zero(), Point::Ones()};
    return {formula_field(formula, unit_cube), finest};
}

}  // namespace

AnalyticField ugawg_linear() {
    return in_unit_cube(
        [](const Point& p) { return Metric{coarsest, coarsest, length_across(p.z()), 0, 0, 0}; });
}

AnalyticField ugawg_polar_1() {
    return in_unit_cube([](const Point& p) {
        const double r = std::hypot(p.x(), p.y());
        return cylindrical_metric(p, r, length_across(r), coarsest);
    });
}

AnalyticField ugawg_polar_2() {
    return in_unit_cube([](const Point& p) {
        const double r = std::hypot(p.x(), p.y());
        const double d = std::min(10 * std::abs(r - 0.5), 1.0);
        return cylindrical_metric(p, r, length_across(r), coarsest * d + 0.025 * (1 - d));
    });
}

}  // namespace controlspace
