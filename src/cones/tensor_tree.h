#pragma once

#include <cstdint>
#include <vector>

#include "cones/cone_tree.h"
#include "cones/tensor_lanes.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Bounding-volume hierarchy over anisotropic sources, eight children a node and eight sources a
/// leaf, for `AnisotropicCones` (which says what follows from the bounds).
class TensorTree {
public:
    /// A source and what is known of it.
    struct Item {
        PointSource source;
        double length;        ///< the metric's smallest
        std::uint32_t index;  ///< among all sources
    };

    /// Bounds of all sources below each child.
    struct Node {
        VectorLanes centre = VectorLanes::zero();
        Lanes radius = Lanes::Zero();  ///< largest |inverse (Q_i - centre)|
        TensorLanes inverse =
            TensorLanes::identity();  ///< no displacement v is shorter in M_i than |inverse v|
        TensorLanes square = TensorLanes::identity();  ///< L^2, where L is within all M_i
        Lanes length;               ///< smallest of all M_i; infinite where there is no child
        std::uint32_t first_child;  ///< of eight that follow one another; leaves come after nodes
    };

    /// Sources side by side.
    struct Leaf {
        VectorLanes position;
        TensorLanes metric;
        Lanes length;  ///< smallest of the metric; infinite where there is no source
    };

    TensorTree() = default;
    /// `weight` is what makes lengths coordinates (see ConeTreeItem). Runs on all of TBB's threads.
    TensorTree(std::vector<Item> items, double weight);

    bool empty() const { return leaves_.empty(); }
    /// The root is number 0, a leaf if there is no node.
    bool is_leaf(std::uint32_t n) const { return n >= nodes_.size(); }
    const Node& node(std::uint32_t n) const { return nodes_[n]; }
    const Leaf& leaf(std::uint32_t n) const { return leaves_[leaf_number(n)]; }
    /// Of the source in a lane of leaf `n`, among all sources.
    std::uint32_t index(std::uint32_t n, int lane) const {
        return indices_[leaf_number(n) * lane_count + static_cast<std::size_t>(lane)];
    }

    /// Bytes allocated: of the metrics, and of what finds them.
    std::size_t bytes_payload() const { return leaves_.capacity() * sizeof(TensorLanes); }
    std::size_t bytes_topology() const {
        return leaves_.capacity() * (sizeof(Leaf) - sizeof(TensorLanes)) +
               nodes_.capacity() * sizeof(Node) + indices_.capacity() * sizeof(std::uint32_t);
    }

private:
    std::size_t leaf_number(std::uint32_t n) const {
        return shape_.leaf_in(n - static_cast<std::uint32_t>(nodes_.size()));
    }
    void put_in_order(std::vector<Item>& items, double weight) const;

    ConeTreeShape shape_;
    std::vector<Node> nodes_;  ///< level by level
    std::vector<Leaf> leaves_;
    std::vector<std::uint32_t> indices_;  ///< in tree order
};

}  // namespace controlspace
