// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// What a user of each library writes who wants lengths of it and nothing else: a loop over places,
// without anything of this project between. Grids take the field at their nodes.

/// Fills `out` with the lengths at the places, which are within the domain.
using Loop = std::function<void(std::span<const Point>, std::span<double> out)>;

inline const Box bare_domain{Point(-1, -1, -1), Point(1, 1, 1)};
inline constexpr double bare_slope = 0.25;  ///< of cones
inline constexpr int bare_voxels = 80;      ///< along each axis
inline constexpr double bare_voxel = 2.0 / bare_voxels;

/// An array of one's own; nodes are the centres of voxels (order 0) or their corners (order 1).
template <int order>
Loop bare_array(const ControlSpace& field);
/// As its documentation has it: an accessor that is kept, and its sampler.
template <int order>
Loop bare_openvdb(const ControlSpace& field);
template <int order>
Loop bare_nanovdb(const ControlSpace& field);
Loop bare_nanoflann(std::span<const PointSource> sources);
Loop bare_netgen(std::span<const PointSource> sources);
/// The leaves of K_oL. To be called once the adapter has started MPI.
Loop bare_p4est(const ControlSpace& octree);
/// CGAL's tetrahedra of the sources and the box's corners.
Loop bare_tets(const ControlSpace& field, std::span<const PointSource> sources);
Loop bare_structured(const ControlSpace& field);
/// The same tetrahedra as a view of Gmsh.
Loop bare_view(const ControlSpace& field, std::span<const PointSource> sources);

}  // namespace controlspace
