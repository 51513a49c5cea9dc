// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "controlspace/geometry/point.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// Where a grid keeps its metrics, and how it answers between them.
enum class Interpolation {
    nearest,    ///< one at each cell's centre, which holds in the whole cell; order 0
    trilinear,  ///< one at each vertex of the cells, those on the boundary included; order 1
};

/// How finely a grid divides its domain. Cells are equal boxes, not always cubes.
struct Voxels {
    Vector cells;        ///< whole numbers >= 1 along x, y and z
    std::string remark;  ///< what the memory cap has cost, or nothing (see Footprint::remark)
};

/// Number of control nodes along x, y and z of a grid of `cells`: one layer in a flat domain.
Vector lattice_nodes(const Box& domain, const Vector& cells, Interpolation interpolation);

/// `cells` rounded up, at least 1; 2 / 0.02 gives 100, whichever way the quotient is rounded.
Vector whole_cells(const Vector& cells);

/// Longest edge that voxels may have: `voxel`, or l_min * finest_length where that is 0.
/// Throws InputError where the options name neither.
double longest_voxel_edge(const SpaceOptions& options);

/// Cells with edges of at most longest_voxel_edge (plus a relative 1e-12 for rounding) where a
/// grid of them fits `max_bytes`, the finest that fit otherwise. What has to fit is
/// `bytes_of(nodes)`, the grid with so many nodes along x, y and z, and what gradation adds to it;
/// besides, nodes must be fewer than 2^32. `bytes_of` must not shrink as nodes grow.
/// Throws InputError where the options are invalid, name no finest length or leave no room for a
/// single cell.
Voxels choose_voxels(const SpaceOptions& options, Interpolation interpolation,
                     const std::function<double(const Vector& nodes)>& bytes_of);

}  // namespace controlspace
