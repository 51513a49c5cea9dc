#pragma once

#include <cstddef>

#include "controlspace/space/control_space.h"

namespace controlspace {

/// Bytes of a tree as the paper's Table 1 counts them: 136 for a leaf, 108 (kd) or 216 (octree) for
/// an inner node, 104 for a kd-tree as a whole, 104 for a control node where they stand at
/// vertices; the metrics of leaves are not counted at all. Only to compare with that table: what is
/// really allocated is Footprint::bytes_total().
inline std::size_t published_bytes(bool is_octree, const Footprint& tree, bool at_vertices) {
    const std::size_t inner_nodes = tree.elements - tree.leaves;
    return 136 * tree.leaves + (is_octree ? 216 * inner_nodes : 108 * inner_nodes + 104) +
           (at_vertices ? 104 * tree.control_nodes : 0);
}

}  // namespace controlspace
