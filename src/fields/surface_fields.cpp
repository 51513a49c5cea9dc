// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/surface_fields.h"

#include <algorithm>
#include <cmath>

#include "controlspace/fields/formula_field.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/sources/point_source.h"
#include "refuse.h"

namespace controlspace {

namespace {

void require_valid(const SurfaceLengths& lengths) {
    require_length("length across of a field", lengths.across);
    require_length("length along of a field", lengths.along);
    require_length("largest length of a field", lengths.largest);
    if (!(lengths.growth >= 0 && is_coordinate(lengths.growth))) {
        refuse("growth {} of a field: give 0 or a positive number", lengths.growth);
    }
}

double finest_length(const SurfaceLengths& l) { return std::min({l.across, l.along, l.largest}); }

Metric metric_at(const SurfaceLengths& l, const Vector& normal, double distance) {
    const auto grown = [&](double length) {
        return std::min(l.largest, length + l.growth * distance);
    };
    return layer_metric(normal, grown(l.across), grown(l.along));
}

template <class Formula>
AnalyticField with_lengths(const SurfaceLengths& lengths, Formula formula) {
    return {formula_field(formula), finest_length(lengths)};
}

}  // namespace

AnalyticField sphere_field(const SphereField& sphere) {
    require_valid(sphere.lengths);
    require_length("radius of a field", sphere.radius);
    require_coordinates("centre of a field", sphere.centre);
    return with_lengths(sphere.lengths, [sphere](const Point& p) {
        const Vector v = p - sphere.centre;
        const double r = v.norm();
        const Vector normal = r > 0 ? Vector(v / r) : Vector(Vector::UnitX());
        return metric_at(sphere.lengths, normal, std::abs(r - sphere.radius));
    });
}

AnalyticField planes_field(const PlanesField& planes) {
    require_valid(planes.lengths);
    if (!is_coordinate(planes.slope)) {
        refuse("slope {} of a field: give a finite number", planes.slope);
    }
    const double stretch = std::sqrt(1 + planes.slope * planes.slope);
    const Vector second = Vector(planes.slope, -1, 0) / stretch;
    return with_lengths(
        planes.lengths, [lengths = planes.lengths, second, offset = 0.2 / stretch](const Point& p) {
            return intersection(metric_at(lengths, Vector::UnitX(), std::abs(p.x() + 0.5)),
                                metric_at(lengths, second, std::abs(second.dot(p) - offset)));
        });
}

}  // namespace controlspace
