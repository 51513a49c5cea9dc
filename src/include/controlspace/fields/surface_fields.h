// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "controlspace/fields/analytic_field.h"

namespace controlspace {

/// Lengths near a surface: `across` and `along` the surface on the surface itself, each growing by
/// `growth` times the distance from it, up to `largest`. In the unit of length of the domain.
struct SurfaceLengths {
    double across = 0.03;
    double along = 0.03;
    double growth = 0.25;
    double largest = largest_magnitude;

    bool operator==(const SurfaceLengths&) const = default;
};

/// Around a sphere: the distance is ||p - centre| - radius|, the direction across is that of
/// p - centre, and x at the centre itself. With equal lengths, isotropic and
/// min(largest, h + growth ||p - centre| - radius|).
struct SphereField {
    Point centre = Point::Zero();
    double radius = 0.8;
    SurfaceLengths lengths = {};
};

/// Around the two unbounded planes of PlanesSampling, (-0.5, u, v) and (u, -0.2 + slope u, v): the
/// intersection of the fields of both.
struct PlanesField {
    double slope = 0;
    SurfaceLengths lengths = {};
};

/// Defined everywhere. Both throw InputError for lengths and a radius that are not positive, for a
/// growth below 0, and for anything that is not finite.
AnalyticField sphere_field(const SphereField& sphere);
AnalyticField planes_field(const PlanesField& planes);

}  // namespace controlspace
