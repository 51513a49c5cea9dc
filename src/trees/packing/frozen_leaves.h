// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "trees/packing/packed_tree.h"
#include "trees/topology/leaf_faces.h"

namespace controlspace {

// What the leaves of compact forms hold (PackedTree), and save(tree, state): as the model does
// whose compact form it is. `M` is what metrics are stored as, `Plane` the type of the numbers of
// planes.

/// Metrics of nodes, and leaves, of which each has its `faces` as numbers of planes.
template <class M, class Leaf>
class FrozenLeaves {
public:
    static constexpr bool are_lengths = is_stored_length<M>;

    FrozenLeaves(CutPlanes planes, StoredMetrics<M> metrics)
        : planes_(std::move(planes)), metrics_(std::move(metrics)) {}

    void prefetch(LeafIndex leaf) const { __builtin_prefetch(&leaves_[leaf]); }
    [[gnu::always_inline]] Box box(LeafIndex leaf) const {
        return leaves_[leaf].faces.box(planes_);
    }
    void describe(Footprint& footprint) const {
        footprint.control_nodes = metrics_.size();
        footprint.bytes_payload = metrics_.bytes();
        footprint.bytes_topology += leaves_.capacity() * sizeof(Leaf) + planes_.bytes();
    }

protected:
    CutPlanes planes_;
    StoredMetrics<M> metrics_;
    std::vector<Leaf> leaves_;
};

/// pack(Plane()) for the type of numbers of planes.
template <class Pack>
auto with_plane(const CutPlanes& planes, Pack&& pack) {
    if (planes.most() > std::size_t{1} << 16) return pack(std::uint32_t());
    return pack(std::uint16_t());
}

/// The compact form of these.
template <class Node, class Values>
std::unique_ptr<ControlSpace> frozen(Topology<Node> tree, Values values) {
    return std::make_unique<PackedTree<Node, Values>>(std::move(tree), std::move(values));
}

}  // namespace controlspace
