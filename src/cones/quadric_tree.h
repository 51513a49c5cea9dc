// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cones/quadric_node.h"
#include "controlspace/sources/point_source.h"
#include "metric/tensor_lanes.h"

namespace controlspace {

/// Bounding-volume hierarchy over sources, with up to eight children a node, nearly all of which
/// are there. The root is node 0; the children of a node follow one another; leaves have the
/// numbers after the nodes.
class QuadricTree {
public:
    QuadricTree() = default;
    /// `uncertainty` is that of the sources' lengths, relative; g is the ratio of those that have
    /// none. Runs on all of TBB's threads; the tree does not depend on their number.
    QuadricTree(std::vector<ConeTreeItem> given, std::span<const PointSource> sources,
                double uncertainty, double g);

    /// Sources of a leaf, but for the last, and vectors of eight of them.
    static constexpr std::uint32_t vectors_of_leaf = 2;
    static constexpr std::uint32_t leaf_size = lane_count * vectors_of_leaf;

    bool empty() const { return vectors_.empty(); }
    bool is_leaf(std::uint32_t number) const { return number >= nodes_.size(); }
    const QuadricNode& node(std::uint32_t number) const { return nodes_[number]; }
    /// The number of the leaf that has a source, given its place in the order.
    std::uint32_t leaf_of(std::uint32_t place) const {
        return static_cast<std::uint32_t>(nodes_.size()) + place / leaf_size;
    }
    /// The first vector of a leaf.
    std::uint32_t first_vector(std::uint32_t number) const {
        return vectors_of_leaf * (number - static_cast<std::uint32_t>(nodes_.size()));
    }
    /// The root is its own parent.
    std::uint32_t parent(std::uint32_t number) const { return parents_[number]; }
    /// All sources in order, eight in each, for the quick test.
    std::span<const QuadricLeaf> vectors() const { return vectors_; }
    /// The rest of the same sources.
    struct Shapes {
        TensorLanes metric;
        Lanes growth = Lanes::Ones();  ///< ratio of the cone
    };
    std::span<const Shapes> shapes() const { return shapes_; }
    /// Given its place in the order.
    PointSource source(std::uint32_t place) const {
        const std::uint32_t vector = place / lane_count;
        const auto lane = static_cast<Eigen::Index>(place % lane_count);
        return {vectors_[vector].position[lane], shapes_[vector].metric[lane],
                shapes_[vector].growth[lane]};
    }
    /// Indices of the sources, in order.
    std::span<const std::uint32_t> indices() const { return indices_; }
    std::size_t bytes() const;

private:
    std::vector<QuadricNode> nodes_;
    std::vector<QuadricLeaf> vectors_;
    std::vector<Shapes> shapes_;          ///< as `vectors_`
    std::vector<std::uint32_t> parents_;  ///< of nodes and leaves
    std::vector<std::uint32_t> indices_;
};

}  // namespace controlspace
