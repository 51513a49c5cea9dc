#pragma once

#include <memory>
#include <vector>

#include "baselines/lattice/voxels.h"
#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Structures whose metrics OpenVDB holds.
std::vector<CatalogueEntry> openvdb_rows();

/// OpenVDB's standard 5-4-3 tree with a whole tensor as its value (six doubles, the payload of all
/// other structures), active and dense over the domain: what a user gets who takes the library as
/// it is. Voxel (i, j, k) is node (i, j, k) of the lattice, so nearest and trilinear answer as the
/// uniform grid with the same voxels does. Leaves of 8^3 voxels that the finished field leaves
/// within `prune_delta` of each other become tiles (openvdb/prune.h).
///
/// 1.8 MB is the least that any grid takes.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                       Interpolation interpolation);

/// A stack of OpenVDB grids, the voxels of each twice as long as those of the one below, in trees
/// of leaves of 4^3 (3-3-2): in effect an octree in hash tables. Every place belongs to a voxel of
/// one grid, so nothing is dense where the field is coarse.
///
/// A new one has 8 to 15 of the largest voxels along the longest edge of the domain. Sources refine
/// it as they refine an octree: their voxel's edges become at most l_min in their metric.
/// Gradation runs over the voxels of all grids, and refines those with an edge above `voxel_factor`
/// in a metric that they hold, until there is none. What refines starts from the metrics before
/// gradation, so it does not hand on what a large voxel had to be content with. No voxel is shorter
/// than `voxel`, or, where that is 0, half of the shortest that l_min and voxel_factor request.
///
/// Leaves of voxels that the finished field leaves within `prune_delta` of each other become tiles;
/// a vertex that several grids have may then differ from grid to grid by as much.
///
/// Nearest: a metric per voxel. Trilinear: one per vertex, also where it hangs on the side of a
/// larger voxel; each grid has a halo of inactive voxels for the vertices on its rim.
///
/// With `takes_later_sources`, each gradation starts from what the sources request, on voxels that
/// they alone have refined: at the cost of the first one, unless nothing has changed.
///
/// Payload is the leaves' values, those that mean nothing included. Throws InputError where options
/// are invalid, and where a structure outgrows `max_bytes`, gradation included.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_levels(const SpaceOptions& options,
                                                         Interpolation interpolation);

/// The form in which other programs could read a field of metrics: two of OpenVDB's own Vec3S
/// trees, dense over the domain, one of (xx, yy, zz) and one of (xy, xz, yz), in floats; a metric
/// per vertex, trilinear. So it holds a metric to some 1e-7 of its lengths, and a query looks every
/// value up twice. Throws InputError for metrics that floats cannot hold, as for anisotropies above
/// about 1e3, and where later sources are to come: their field would depend on rounding.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_vec3s(const SpaceOptions& options);

}  // namespace controlspace
