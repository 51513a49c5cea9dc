// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "controlspace/geometry/box.h"

namespace controlspace {

/// A box in tetrahedra that are bisected where they are to be smaller, by newest vertices (J.
/// Maubach, 1995): cubes, or nearly, of six tetrahedra each in the beginning; three bisections
/// halve all edges, and shapes stay a few. `close` makes it conforming: neighbours share whole
/// faces.
class BisectedBox {
public:
    explicit BisectedBox(const Box& box);

    using Corners = std::array<std::uint32_t, 4>;

    /// Bisects the tetrahedron at `x` until no edge of its box is longer than that of `cell`.
    void refine_to(const Box& cell, const Point& x);
    /// Bisects those that `wanted` names, of the present ones.
    void refine(const std::vector<std::size_t>& wanted);
    /// Bisects neighbours until all share whole faces.
    void close();

    std::span<const Point> points() const { return points_; }
    /// Numbers of the tetrahedra that are not bisected.
    std::vector<std::size_t> leaves() const;
    const Corners& corners(std::size_t tetrahedron) const { return all_[tetrahedron].corners; }

    /// The corners of the tetrahedron at `x`, and their weights there.
    struct Place {
        std::size_t tetrahedron;
        std::array<double, 4> weights;
    };
    Place place_of(const Point& x) const;

private:
    struct Tetrahedron {
        Corners corners;          ///< bisected between the first and the corner `cut`
        std::uint8_t cut = 3;     ///< 3, 2 or 1
        std::uint32_t parts = 0;  ///< the first of two; 0: not bisected
    };

    void descend(Place& place) const;
    void bisect(std::size_t tetrahedron);
    std::uint32_t middle(std::uint32_t a, std::uint32_t b);

    Box box_;
    std::array<int, 3> cubes_{};  ///< along each axis
    std::vector<Point> points_;
    std::vector<Tetrahedron> all_;
    std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< of edges
    std::vector<std::uint64_t> new_edges_;                      ///< bisected since `close`
};

}  // namespace controlspace
