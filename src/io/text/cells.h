// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// The cells of any structure, each once: the leaves of a tree, the cells of a grid, as far as
/// they lie in the domain. Found by calls of cell_at alone, for any structure; in ascending order
/// of their low corners, x first.
std::vector<Box> elements_of(const ControlSpace& space);
/// The same of those in `regions`, unions of cells.
std::vector<Box> elements_of(const ControlSpace& space, std::span<const Box> regions);

/// The corners of a box (numbered as by `corner`) in the order of VTK's and Gmsh's hexahedra, which
/// goes around each face.
inline constexpr std::array<int, 8> hexahedron_corners{0, 1, 3, 2, 4, 5, 7, 6};

/// The corners of the cells of this domain, in that order: eight, or in a flat domain the four of a
/// quadrilateral.
std::vector<int> cell_corners(const Box& domain);

}  // namespace controlspace
