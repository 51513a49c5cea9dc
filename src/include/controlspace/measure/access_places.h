// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/sources/source_columns.h"

namespace controlspace {

// Places beside random ones and those of a grid (measure/access_time.h, measure/accuracy.h) at
// which the access is timed: the same for the same seed on every machine.

/// `n` places near the sources: a source drawn at random, and around it a place drawn uniformly
/// from the ellipsoid of two of its lengths in each direction (a ball, of an isotropic source).
/// Places outside `domain` are drawn again, source and all; across a flat one there is no offset.
/// Precondition: there are sources, all in the domain.
std::vector<Point> places_near(const SourceColumns& sources, const Box& domain, std::size_t n,
                               std::uint64_t seed);

/// `n` places where the reference's lengths are small, for a field without point sources: one of
/// the tenth of the probes (cell centres of a grid with `count` cells along each axis) with the
/// smallest lengths drawn at random, and a place drawn uniformly from its cell.
std::vector<Point> places_where_fine(const Probes& probes, int count, const Box& domain,
                                     std::size_t n, std::uint64_t seed);

/// `n` places of walks, one after the other, of at most 1000 places each. A walk begins at one of
/// `starts`, drawn at random; each step has a random direction and half the length that `field`
/// requests in it. A step that leads out of the domain ends at its nearest place.
std::vector<Point> walks(const ControlSpace& field, const Box& domain,
                         std::span<const Point> starts, std::size_t n, std::uint64_t seed);

}  // namespace controlspace
