#pragma once

#include <memory>

#include "baselines/lattice/voxels.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// A stack of OpenVDB grids, the voxels of each twice as long as those of the one below, in trees
/// of leaves of 4^3 (3-3-2): in effect an octree in hash tables. Every place belongs to a voxel of
/// one grid, so nothing is dense where the field is coarse.
///
/// A new one has 8 to 15 of the largest voxels along the longest edge of the domain. Sources refine
/// it as they refine an octree: their voxel's edges become at most l_min in their metric.
/// Gradation runs over the voxels of all grids, and refines those with an edge above `voxel_factor`
/// in a metric that they hold, until there is none. What refines starts from the metrics before
/// gradation, so it does not hand on what a large voxel had to be content with. No voxel is shorter
/// than `voxel`, or, where that is 0, half of the shortest that l_min and voxel_factor ask for.
///
/// Leaves of voxels that gradation, or an assignment, leaves within `prune_delta` of each other
/// become tiles; a vertex
/// that several grids have may then differ from grid to grid by as much.
///
/// Nearest: a metric per voxel. Trilinear: one per vertex, also where it hangs on the side of a
/// larger voxel; each grid has a halo of inactive voxels for the vertices on its rim.
///
/// With `takes_later_sources`, each gradation starts from what the sources ask for, on voxels that
/// they alone have refined: at the cost of the first one, unless nothing has changed.
///
/// Footprint: payload is the leaves' values, those that mean nothing included. Throws InputError
/// where options are invalid, and where a structure outgrows `max_bytes`, gradation included.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_levels(const SpaceOptions& options,
                                                  Interpolation interpolation);

}  // namespace controlspace
