// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <vector>

#include "trees/topology/topology.h"

namespace controlspace {

/// Leaves of an octree, shared out: the ranks that own them, and all in p4est's order.
struct SharedOctants {
    std::vector<int> owner;        ///< by leaf
    std::vector<LeafIndex> order;  ///< those of each rank together
};

/// Collective: shares out the leaves of a tree that is the same on all ranks, so that ranks have
/// like sums of `weights`, by leaf.
SharedOctants share_out(MPI_Comm comm, const Topology<OctreeNode>& tree,
                        std::span<const std::uint64_t> weights);

}  // namespace controlspace
