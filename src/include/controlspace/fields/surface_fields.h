#pragma once

#include <limits>

#include "controlspace/fields/analytic_field.h"

namespace controlspace {

/// Lengths beside a surface: `across` it and `along` it on the surface itself, each growing by
/// `growth` times the distance from it, up to `largest`.
struct SurfaceLengths {
    double across = 0.03;
    double along = 0.03;
    double growth = 0.25;
    double largest = largest_magnitude;

    bool operator==(const SurfaceLengths&) const = default;
};

/// Around a sphere: |p - centre| gives the distance, p - centre the direction across, and any
/// direction will do at the centre itself (x). With equal lengths, isotropic and
/// min(largest, h + growth ||p - centre| - radius|).
struct SphereField {
    Point centre = Point::Zero();
    double radius = 0.8;
    SurfaceLengths lengths = {};
};

/// Around the two planes of PlanesSampling, (-0.5, u, v) and (u, -0.2 + slope u, v) without end:
/// the intersection of the fields of either.
struct PlanesField {
    double slope = 0;
    SurfaceLengths lengths = {};
};

/// Both throw InputError for lengths and a radius that are not positive numbers, for a growth below
/// 0, and for anything that is not finite.
AnalyticField sphere_field(const SphereField& sphere);
AnalyticField planes_field(const PlanesField& planes);

}  // namespace controlspace
