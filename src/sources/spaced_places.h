#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Places of which no two are nearer to each other than `spacing`. Found by a hash table over cubes
/// of that edge; coordinates must be less than 2^53 spacings from the origin.
class SpacedPlaces {
public:
    /// For about `expected` places; more only take longer.
    SpacedPlaces(double spacing, std::size_t expected);

    /// Takes `p` in, unless a place in here is nearer than the spacing.
    bool add(const Point& p);

    const std::vector<Point>& places() const { return places_; }

private:
    using Cube = std::array<std::int64_t, 3>;

    std::size_t chain_of(const Cube& cube) const;

    double spacing_;
    std::vector<Point> places_;
    std::vector<std::uint32_t> first_;  ///< by chain: a place in it, or `none`
    std::vector<std::uint32_t> next_;   ///< by place: another of the same chain, or `none`
};

}  // namespace controlspace
