#pragma once

#include <openvdb/tree/Tree.h>

#include <cstddef>
#include <cstdint>

#include "controlspace/geometry/point.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

// Trees of OpenVDB that are active and dense over a lattice, voxel (i, j, k) being node (i, j, k).
// Index space starts at 0, since a box around the origin would touch up to eight upper nodes of
// 1.6 MB each. The tree stands without openvdb::Grid: all that Grid adds is a transform, which
// would be a virtual call per point. openvdb::initialize() is not called: it serves files alone.

inline openvdb::Coord voxel(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return {static_cast<openvdb::Int32>(i), static_cast<openvdb::Int32>(j),
            static_cast<openvdb::Int32>(k)};
}

/// What denseFill does, but on the one thread that makes every other structure too.
template <class Tree>
void fill_densely(Tree& tree, const Lattice& lattice, const typename Tree::ValueType& value) {
    const auto [nx, ny, nz] = lattice.nodes;
    tree.sparseFill({voxel(0, 0, 0), voxel(nx - 1, ny - 1, nz - 1)}, value);
    tree.voxelizeActiveTiles(/*threaded=*/false);
}

/// Bytes of the values of a leaf.
template <class Tree>
constexpr std::size_t leaf_values_bytes = Tree::LeafNodeType::SIZE *
                                          sizeof(typename Tree::ValueType);

/// What a dense tree over so many nodes will allocate.
template <class Tree>
double dense_bytes(const Vector& nodes) {
    using Leaf = typename Tree::LeafNodeType;
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    const auto blocks = [&](double side) { return (nodes.array() / side).ceil().prod(); };
    return blocks(Leaf::DIM) * (sizeof(Leaf) + leaf_values_bytes<Tree>)+blocks(Lower::DIM) *
               sizeof(Lower) +
           blocks(Upper::DIM) * sizeof(Upper) + sizeof(Tree);
}

/// Payload is the leaves' values; topology the rest of the tree, as OpenVDB counts it.
template <class Tree>
void add_dense_bytes(const Tree& tree, Footprint& footprint) {
    const std::size_t payload = tree.leafCount() * leaf_values_bytes<Tree>;
    footprint.bytes_payload += payload;
    footprint.bytes_topology += tree.memUsage() - payload;
}

}  // namespace controlspace
