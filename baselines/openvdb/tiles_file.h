// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "baselines/openvdb/octree_voxels.h"
#include "controlspace/space/detail/state.h"

namespace controlspace {

// The .vdb file of openvdb-tiles, which programs that know OpenVDB read: a FloatGrid `length`,
// whose active tiles and voxels are the leaves of the octree; the domain, for people, is among its
// metadata (domain_low, domain_high). Where OpenVDB's transforms end, voxels of some 1e-5, places
// and lengths are multiplied by a power of two, the metadatum `scale`. Metadata of the file: the
// state of a .ctrl without lengths, as hexadecimal digits (controlspace_state), and its seal
// (sealed_vdb.h).

/// That file, unsealed: `state` without the octree, which is added. `lengths` are of its leaves,
/// depth first.
std::string tiles_file(StateWriter state, const Octants& octree, std::span<const float> lengths);

}  // namespace controlspace
