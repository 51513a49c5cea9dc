#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/point.h"

namespace controlspace {

/// Shape of a balanced binary tree over `size` items in tree order. Nodes are numbered from the
/// root, 1; the children of i are 2i and 2i+1; the leaves are the last 2^depth nodes. Nothing is
/// stored: which items a node holds follows from its number.
struct ConeTreeShape {
    std::uint64_t size = 0;
    int depth = 0;  ///< levels below the root

    /// The least depth whose leaves hold at most `leaf_size` items.
    static ConeTreeShape with_leaves_of(std::uint64_t size, std::uint64_t leaf_size);

    std::uint32_t first_leaf() const { return std::uint32_t{1} << depth; }
    std::uint32_t nodes() const { return 2 * first_leaf(); }  ///< node 0, unused, included
    bool is_leaf(std::uint32_t node) const { return node >= first_leaf(); }
    /// The items of `node` are begin(node) .. end(node) - 1.
    std::size_t begin(std::uint32_t node) const { return cut(node, 0); }
    std::size_t end(std::uint32_t node) const { return cut(node, 1); }

private:
    std::size_t cut(std::uint32_t node, std::uint64_t side) const {
        const int level = std::bit_width(node) - 1;
        return size * (node - (std::uint64_t{1} << level) + side) >> level;
    }
};

/// An item to be put in tree order: a place, and its length at the place divided by the slope
/// g - 1 of its cone, which makes the length a coordinate as the others are.
struct ConeTreeItem {
    double coordinates[4];
    std::uint32_t index;  ///< of the source
};

/// Puts `items` in tree order: every node is cut at the median of its longest extent, so that its
/// items are near each other and of like lengths. Runs on all of TBB's threads; the order does not
/// depend on their number.
void sort_for_tree(const ConeTreeShape& shape, std::span<ConeTreeItem> items);

}  // namespace controlspace
