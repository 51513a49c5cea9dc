// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
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

/// A sparse tree of OpenVDB that follows the error: the leaves of an octree, K_oL's, as voxels of
/// the finest of them, or as tiles where they are as large as a node. It answers as K_oL does, to
/// the bit, and its insertion, gradation, adaptation and proof are K_oL's: what is compared is how
/// the field is held. That is the standard 5-4-3 tree, as every program reads it; for codes, up to
/// 512 voxels along an axis, one of 8^3 children a node (3-3-3). Voxels have the shape of the
/// domain's octants: an axis is halved as the octree halves it. Beyond 4096 voxels along an axis a
/// query asks the root, which is slower, and the footprint says so; leaves are cut to level 16 at
/// most. Throws MemoryLimitError before nodes outgrow the cap on memory.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_tiles(const SpaceOptions& options);

/// A sparse tree of OpenVDB that refers to bricks, the counterpart of K_V and K_oV: boxes of 4^3
/// cells, or 4^2 on a plane, each with all of its 5^3 vertices, trilinear between them. It is
/// K_oV's octree in which leaves are cut together so that they fill bricks: insertion by l_min and
/// tolerance, gradation, adaptation and proof are those of K_oV with such leaves, and it answers as
/// this octree does, to rounding. A voxel is the finest brick, larger ones are tiles; a value is
/// the place of a brick in one pool, its kind and its level. Up to 32 voxels along an axis the tree
/// has two levels (2-3), up to 512 nodes have 8^3 children (3-3-3), beyond it is the standard tree;
/// beyond 4096 a query asks the root, which is slower, and the footprint says so. Bricks are cut to
/// level 16 at most.
///
/// In codes each brick has its own range, in equal steps of its lengths: no code rounds more than
/// those of as many bits in trees do, and a brick for which that takes more bits gets them. Throws
/// MemoryLimitError before bricks or nodes outgrow the cap on memory.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_bricks(const SpaceOptions& options);

/// The state of a .ctrl in a .vdb file of tiles or bricks (octree_file.h). Throws InputError, which
/// names `file`.
std::string state_in_octree_file(const std::string& bytes, const std::string& file);

/// The form in which other programs could read a field of metrics: two of OpenVDB's own Vec3S
/// trees, dense over the domain, one of (xx, yy, zz) and one of (xy, xz, yz), in floats; a metric
/// per vertex, trilinear. So it holds a metric to some 1e-7 of its lengths, and a query looks every
/// value up twice. Throws InputError for metrics that floats cannot hold, as for anisotropies above
/// about 1e3, and where later sources are to come: their field would depend on rounding.
std::unique_ptr<ControlSpaceBuilder> make_openvdb_vec3s(const SpaceOptions& options);

}  // namespace controlspace
