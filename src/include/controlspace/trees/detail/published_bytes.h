#pragma once

#include <cstddef>

namespace controlspace {

/// Bytes of a tree as the paper's Table 1 counts them: 136 for a leaf, 108 (kd) or 216 (octree) for
/// an inner node, 104 for a kd-tree as a whole, 104 for a control node where they stand at
/// vertices; the metrics of leaves are not counted at all. Only to compare with that table: what is
/// really allocated is Footprint::bytes_total().
struct PublishedTree {
    bool octree = false;
    bool vertices = false;
    std::size_t leaves = 0;
    std::size_t inner_nodes = 0;
    std::size_t control_nodes = 0;
};

inline std::size_t published_bytes(const PublishedTree& tree) {
    return 136 * tree.leaves + (tree.octree ? 216 : 108) * tree.inner_nodes +
           (tree.octree ? 0 : 104) + (tree.vertices ? 104 * tree.control_nodes : 0);
}

}  // namespace controlspace
