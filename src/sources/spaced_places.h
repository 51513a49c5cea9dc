#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Points of which no two are nearer to each other than `spacing`: a hash table over cubes of that
/// edge. Coordinates must be less than 2^53 spacings from the origin.
class SpacedPlaces {
public:
    /// For about `expected` points; more are only slower.
    SpacedPlaces(double spacing, std::size_t expected)
        : spacing_(spacing), first_(std::bit_ceil(2 * expected + 1), none) {}

    /// Adds `p`, unless a point is nearer to it than the spacing; returns whether it did.
    bool add(const Point& p) {
        const auto is_near = [&](const Cube& cube) {
            for (std::uint32_t i = first_[chain_of(cube)]; i != none; i = points_[i].next) {
                if ((points_[i].position - p).norm() < spacing_) return true;
            }
            return false;
        };
        Cube own;
        for (std::size_t a = 0; a < 3; ++a) {
            own[a] = static_cast<std::int64_t>(std::floor(p[static_cast<Axis>(a)] / spacing_));
        }
        if (is_near(own)) return false;  // most likely
        for (std::int64_t i = 0; i < 27; ++i) {
            if (is_near({own[0] + i / 9 - 1, own[1] + i / 3 % 3 - 1, own[2] + i % 3 - 1})) {
                return false;
            }
        }
        std::uint32_t& chain = first_[chain_of(own)];
        points_.push_back({p, chain});
        chain = static_cast<std::uint32_t>(points_.size() - 1);
        return true;
    }

private:
    using Cube = std::array<std::int64_t, 3>;
    struct Chained {
        Point position;
        std::uint32_t next;  ///< another point of the same chain, or `none`
    };
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    std::size_t chain_of(const Cube& cube) const {
        std::uint64_t hash = 0;
        for (const std::int64_t i : cube) {
            hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15;
            hash ^= hash >> 32;
        }
        return hash & (first_.size() - 1);
    }

    double spacing_;
    std::vector<Chained> points_;
    std::vector<std::uint32_t> first_;  ///< by chain: a point in it, or `none`
};

}  // namespace controlspace
