// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/tree/Tree.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/octree_voxels.h"

namespace controlspace {

// Trees of OpenVDB with a value for each box of voxels: tiles where a box is as large as a node.

/// Bytes of the nodes that the boxes take as voxels and tiles, as the tree counts its memory.
template <class Tree>
double bytes_for(const VoxelBoxes& boxes) {
    // Nodes of `side` voxels that hold a part of a box smaller than they are.
    const auto count = [&](std::int32_t side) {
        std::vector<Cell> nodes;
        for (const VoxelBox& leaf : boxes.leaves) {
            if (std::ranges::min(leaf.edges) >= side) continue;
            Cell from, to;
            for (std::size_t a = 0; a < 3; ++a) {
                from[a] = leaf.low[a] / side;
                to[a] = (leaf.low[a] + leaf.edges[a] - 1) / side;
            }
            for (Cell at = from; at[0] <= to[0]; ++at[0]) {
                for (at[1] = from[1]; at[1] <= to[1]; ++at[1]) {
                    for (at[2] = from[2]; at[2] <= to[2]; ++at[2]) {
                        if (nodes.empty() || nodes.back() != at) nodes.push_back(at);
                    }
                }
            }
        }
        std::ranges::sort(nodes);
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        return static_cast<double>(nodes.size());
    };
    // What lies outside of all children is a tile of the root, in a map.
    constexpr double root_entry = 80;
    double in_root = 1;
    for (const std::int32_t n : boxes.voxels) {
        constexpr auto side = static_cast<std::int32_t>(Tree::RootNodeType::ChildNodeType::DIM);
        const std::int32_t children = n / side + 1;
        in_root *= children;
    }
    return bytes_of_nodes<Tree>(count) + in_root * root_entry;
}

/// Enters value_of(leaf) for each box.
template <class Tree, class ValueOf>
void fill(Tree& tree, const VoxelBoxes& boxes, const ValueOf& value_of) {
    for (const auto& [leaf, low, edges] : boxes.leaves) {
        const openvdb::Coord from(low[0], low[1], low[2]);
        const openvdb::Coord beyond = from.offsetBy(edges[0], edges[1], edges[2]);
        tree.fill({from, beyond.offsetBy(-1)}, value_of(leaf));
    }
}

}  // namespace controlspace
