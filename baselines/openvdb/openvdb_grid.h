#pragma once

#include <memory>

#include "baselines/lattice/voxels.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// OpenVDB's standard 5-4-3 tree with a whole tensor as its value (six doubles, the payload of all
/// other structures), active and dense over the domain: what a user gets who takes the library as
/// it is. Voxel (i, j, k) is node (i, j, k) of the lattice, so nearest and trilinear answer as the
/// uniform grid with the same voxels does. Leaves of 8^3 voxels that gradation, or an
/// assignment, leaves within `prune_delta` of each other become tiles (see baselines/vdb_prune.h).
///
/// Footprint: payload is the leaves' values, those that fill up the outermost leaves included;
/// topology is the inner nodes and the rest of the leaves, as OpenVDB's own memUsage counts them.
/// Voxels as `choose_voxels` has them, which throws InputError; 1.8 MB is the least that any grid
/// takes.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                Interpolation interpolation);

}  // namespace controlspace
