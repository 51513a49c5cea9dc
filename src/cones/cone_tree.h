#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Shape of a balanced binary tree over `size` items in tree order. Nodes are numbered from the
/// root, 1; the children of i are 2i and 2i+1; the last 2^depth nodes hold a leaf or, the number of
/// leaves being no power of two, nothing. All leaves but the last are full. Nothing is stored:
/// which items a node holds follows from its number.
struct ConeTreeShape {
    std::uint64_t size = 0;
    std::uint64_t leaf_size = 1;
    std::uint64_t leaves = 0;
    int depth = 0;  ///< levels below the root

    static ConeTreeShape with_leaves_of(std::uint64_t size, std::uint64_t leaf_size);

    std::uint32_t first_slot() const { return std::uint32_t{1} << depth; }
    bool is_slot(std::uint32_t node) const { return node >= first_slot(); }
    /// Which leaf the slot first_slot() + `slot` holds, if it holds one.
    std::size_t leaf_in(std::uint32_t slot) const { return leaves * slot >> depth; }
    /// The items of `node` are begin(node) .. end(node) - 1; there are none in an empty slot alone.
    std::size_t begin(std::uint32_t node) const { return cut(node, 0); }
    std::size_t end(std::uint32_t node) const { return cut(node, 1); }

private:
    std::size_t cut(std::uint32_t node, std::uint64_t side) const {
        const int level = std::bit_width(node) - 1;
        const std::uint64_t leaf = leaves * (node - (std::uint64_t{1} << level) + side) >> level;
        return std::min(size, leaf_size * leaf);
    }
};

/// Levels of the binary tree whose nodes make a tree of eight children a node, from the root on:
/// each third level, counted from the leaves, which are left out. The root takes what is left over,
/// and may have two or four.
std::vector<int> levels_of_eight_children(int depth);

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
