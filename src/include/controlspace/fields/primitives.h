// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/fields/analytic_field.h"

namespace controlspace {

/// The largest growth of a primitive, as a gradation ratio: the steepest that trees can follow
/// within an element.
inline constexpr double steepest_primitive = 5;

enum class Shape { box, ball, cylinder, segment, surface };

/// A continuous source: a body, a segment or a surface that requests the same length in all
/// directions on it and inside, and h + (g - 1) d at the distance d from it.
///
/// As a text: the shape, a colon, and its numbers and settings between commas:
///
///   box:x0,x1,y0,y1,z0,z1,h=0.02          a solid, as in `domain`
///   ball:x,y,z,r=0.1,h=0.02               a solid
///   cylinder:x0,y0,z0,x1,y1,z1,r=0.1,h=0.02   a solid between the centres of its ends
///   segment:x0,y0,z0,x1,y1,z1,h=0.02
///   surface:part.stl,h=0.02               the triangles of a file, growing on both sides
///
/// and g=1.5 for a growth of its own, as a gradation ratio from 1 to 5, the steepest that trees can
/// follow.
struct Primitive {
    Shape shape = Shape::ball;
    Point a = Point::Zero();           ///< lowest corner, centre, or one end
    Point b = Point::Zero();           ///< highest corner, or the other end
    double radius = 0;                 ///< ball and cylinder
    double h = 0;                      ///< on it and inside
    std::optional<double> ratio = {};  ///< g; none: that of the other sources
    std::filesystem::path file = {};   ///< surface only

    bool operator==(const Primitive&) const = default;
};

/// Whether a text begins like a primitive: with the name of a shape and a colon.
bool is_primitive(std::string_view text);

/// Throws InputError, with the text, for what is no primitive: unknown settings, numbers that are
/// missing, not finite or out of range, corners in another order, ends at the same place.
Primitive parse_primitive(std::string_view text);

/// The text, which parse_primitive reads again to the same bits.
std::string to_string(const Primitive& primitive);

/// The distance from a set of points, and where these are.
struct DistanceField {
    std::function<double(const Point&)> distance;  ///< called from several threads at once
    Box box;                                       ///< around the points
    std::vector<Point> places;                     ///< some of them, all over the set
};

/// The exact distance from a primitive, 0 inside of it. Precondition: not a surface.
DistanceField distance_from(const Primitive& primitive);

/// The smallest length that any of the primitives requests, exact everywhere; `distances` are those
/// from each of them, and `ratio` is the growth of those without one. Throws InputError without
/// primitives.
AnalyticField primitives_field(std::span<const Primitive> primitives,
                               std::vector<DistanceField> distances, double ratio);

}  // namespace controlspace
