// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "controlspace/geometry/subdivision.h"
#include "trees/topology/corners.h"

namespace controlspace {

/// The corners of the children of a box that is cut, as control nodes. They stand on a lattice of
/// up to 3 x 3 x 3 places: per axis the low face, the cut and the high face.
class CutLattice {
public:
    /// Most places that are no corners of the box: of one cut, and of three.
    static constexpr std::size_t most_new_of_one = 4, most_new = 19;

    /// `old` are the corners of the box.
    CutLattice(const Subdivision& subdivision, const Corners& old);

    struct Place {
        std::size_t at;  ///< in the lattice
        Point x;
    };
    /// Those that are no corners of the box, each once; their nodes are to be set.
    std::span<const Place> new_places() const { return std::span(new_).first(count_); }
    void set(const Place& place, NodeIndex node) { nodes_[place.at] = node; }

    /// The corners of child `c`.
    Corners child(int c) const;

private:
    std::array<NodeIndex, 27> nodes_;
    std::array<Place, most_new> new_;
    std::size_t count_ = 0;
    std::array<std::array<std::size_t, 8>, 8> corners_at_;  // of the children, in the lattice
};

}  // namespace controlspace
