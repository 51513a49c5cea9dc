#include "sources/spaced_places.h"

#include <bit>
#include <cmath>

namespace controlspace {

namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};

std::int64_t cube_index(double coordinate, double spacing) {
    return static_cast<std::int64_t>(std::floor(coordinate / spacing));
}

}  // namespace

SpacedPlaces::SpacedPlaces(double spacing, std::size_t expected)
    : spacing_(spacing), first_(std::bit_ceil(2 * expected + 1), none) {}

bool SpacedPlaces::add(const Point& p) {
    const auto is_near = [&](const Cube& cube) {
        for (std::uint32_t i = first_[chain_of(cube)]; i != none; i = next_[i]) {
            if ((places_[i] - p).norm() < spacing_) return true;
        }
        return false;
    };
    const Cube own{cube_index(p.x(), spacing_), cube_index(p.y(), spacing_),
                   cube_index(p.z(), spacing_)};
    if (is_near(own)) return false;  // the most likely place of a neighbour
    for (std::int64_t i = -1; i <= 1; ++i) {
        for (std::int64_t j = -1; j <= 1; ++j) {
            for (std::int64_t k = -1; k <= 1; ++k) {
                if (is_near({own[0] + i, own[1] + j, own[2] + k})) return false;
            }
        }
    }
    std::uint32_t& chain = first_[chain_of(own)];
    next_.push_back(chain);
    chain = static_cast<std::uint32_t>(places_.size());
    places_.push_back(p);
    return true;
}

std::size_t SpacedPlaces::chain_of(const Cube& cube) const {
    std::uint64_t hash = 0;
    for (const std::int64_t i : cube) {
        hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15;
        hash ^= hash >> 32;
    }
    return hash & (first_.size() - 1);
}

}  // namespace controlspace
