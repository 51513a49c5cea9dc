// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "baselines/openvdb/octree_voxels.h"
#include "controlspace/metric/metric.h"
#include "space/state.h"

namespace controlspace {

// The .vdb files of openvdb-tiles and openvdb-bricks, which programs that know OpenVDB read.
//
// Of tiles: a FloatGrid `length`, whose active tiles and voxels are the leaves of the octree. Of
// bricks: a FloatGrid for each level of the octree that has bricks, `length_0` of its root,
// `length_1` below it and so on; active voxels are the vertices of these bricks, at their places,
// and between them a length is trilinear.
//
// The domain, for people, is among the metadata of each grid (domain_low, domain_high). Where
// OpenVDB's transforms end, voxels of some 1e-5, places and lengths are multiplied by a power of
// two, the metadatum `scale`. Metadata of the file: the state of a .ctrl without lengths, as
// hexadecimal digits (controlspace_state), and its seal (sealed_vdb.h).

/// What these files hold. Throws InputError for lengths that are beyond floats.
std::vector<float> lengths_in_floats(std::span<const Metric> isotropic);

/// The file of tiles, unsealed: `state` without the octree, which is added. `lengths` are of its
/// leaves, depth first.
std::string tiles_file(StateWriter state, const Octants& octree, std::span<const float> lengths);

/// The file of bricks in the same way. `lengths` are of the vertices of its bricks: brick by brick,
/// depth first, in each as BrickLattice numbers them. Where bricks of a level meet, those of the
/// last one are written.
std::string bricks_file(StateWriter state, const Octants& octree, std::span<const float> lengths);

}  // namespace controlspace
