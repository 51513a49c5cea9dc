// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// A source in a tree of cones: its position, and its length divided by the slope g - 1 of its
/// cone, which makes the length a coordinate as the others are.
struct ConeTreeItem {
    std::array<double, 4> coordinates;
    std::uint32_t index;  ///< of the source

    Point position() const { return {coordinates[0], coordinates[1], coordinates[2]}; }
};

/// Shape of a balanced binary tree over `size` items in tree order. Binary nodes are numbered from
/// the root, 1; the children of i are 2i and 2i+1; the last 2^depth nodes are slots, which hold a
/// leaf or, the number of leaves being no power of two, nothing. All leaves but the last are full.
/// Nothing is stored: which items a binary node holds follows from its number.
///
/// A ConeTree keeps each third level of it, counted from the leaves. Its root has what is left
/// over, and may have two or four children.
struct ConeTreeShape {
    std::uint64_t size = 0;
    std::uint64_t leaf_size = 1;
    std::uint64_t leaves = 0;
    int depth = 0;  ///< binary levels below the root

    static ConeTreeShape with_leaves_of(std::uint64_t size, std::uint64_t leaf_size);

    /// Nodes of a ConeTree of this shape.
    std::uint32_t nodes() const {
        std::uint32_t count = 0;
        for (int level = depth; level > 0;) {
            level = std::max(0, level - 3);
            count += std::uint32_t{1} << level;
        }
        return count;
    }
    bool is_slot(std::uint32_t binary) const { return binary >= std::uint32_t{1} << depth; }
    /// Which leaf a slot, counted from 0, holds, if it holds one.
    std::size_t leaf_in(std::uint32_t slot) const { return leaves * slot >> depth; }
    /// The items of a binary node are begin .. end - 1; there are none in an empty slot alone.
    std::size_t begin(std::uint32_t binary) const { return cut(binary, 0); }
    std::size_t end(std::uint32_t binary) const { return cut(binary, 1); }

private:
    std::size_t cut(std::uint32_t binary, std::uint64_t side) const {
        const int level = static_cast<int>(std::bit_width(binary)) - 1;
        const std::uint64_t leaf = leaves * (binary - (std::uint64_t{1} << level) + side) >> level;
        return std::min(size, leaf_size * leaf);
    }
};

/// Puts the `middle` items that come first along the longest extent of all first.
void cut_longest_extent(std::span<ConeTreeItem> items, std::size_t middle);

/// Puts `items` in tree order: every binary node is cut at the median of its longest extent, so
/// that its items are near each other and of like lengths. Runs on all of TBB's threads; the order
/// does not depend on their number.
void sort_for_tree(const ConeTreeShape& shape, std::span<ConeTreeItem> items);

/// Bounding-volume hierarchy over items in tree order, with eight children a node.
///
/// Nodes are numbered level by level from the root, 0, and leaves follow them; the root is a leaf
/// if there is no node. The children of a node follow one another. `Node` and `Leaf` have a vector
/// `length` with a lower bound of the lengths of each child or item, infinite where there is none.
template <class Node, class Leaf>
class ConeTree {
public:
    static constexpr std::uint32_t arity = 8;

    /// A child while the tree is built; without items where there is none.
    struct Child {
        std::uint32_t number;
        std::span<const ConeTreeItem> items;
    };

    /// Puts `items` in order and builds a tree over them on all of TBB's threads: calls
    /// make_leaf(items, leaf) for all leaves, then make_node(children, node, number) for all nodes,
    /// level by level from the leaves.
    template <class MakeLeaf, class MakeNode>
    void build(std::span<ConeTreeItem> items, std::uint64_t leaf_size, const MakeLeaf& make_leaf,
               const MakeNode& make_node) {
        // What was built before goes first, so that both are never there.
        nodes_ = std::vector<Node>();
        leaves_ = std::vector<Leaf>();
        shape_ = ConeTreeShape::with_leaves_of(items.size(), leaf_size);
        sort_for_tree(shape_, items);
        const auto part = [&](std::size_t begin, std::size_t end) {
            return std::span<const ConeTreeItem>(items).subspan(begin, end - begin);
        };
        indices_ = std::vector<std::uint32_t>(items.size());
        std::transform(items.begin(), items.end(), indices_.begin(),
                       [](const ConeTreeItem& item) { return item.index; });
        leaves_ = std::vector<Leaf>(shape_.leaves);
        tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t l) {
            const std::size_t begin = l * leaf_size;
            make_leaf(part(begin, std::min<std::size_t>(begin + leaf_size, items.size())),
                      leaves_[l]);
        });
        nodes_ = std::vector<Node>(shape_.nodes());
        std::uint32_t first = shape_.nodes();  // of the level
        for (int level = shape_.depth; level > 0;) {
            const std::uint32_t first_below = first;
            const std::uint32_t size_below = std::uint32_t{1} << level;
            level = std::max(0, level - 3);
            const std::uint32_t size = std::uint32_t{1} << level;
            const std::uint32_t children = size_below / size;
            first -= size;
            if (level == 0) offset_ = children - 7;
            tbb::parallel_for(std::uint32_t{0}, size, [&](std::uint32_t n) {
                std::array<Child, arity> of_node;
                for (std::uint32_t c = 0; c < children; ++c) {
                    const std::uint32_t child = n * children + c;
                    const std::uint32_t binary = size_below + child;
                    of_node[c] = {first_below + child,
                                  part(shape_.begin(binary), shape_.end(binary))};
                }
                make_node(std::span<const Child>(of_node).first(children), nodes_[first + n],
                          first + n);
            });
        }
    }

    bool empty() const { return leaves_.empty(); }
    bool is_leaf(std::uint32_t number) const { return number >= nodes_.size(); }
    const Node& node(std::uint32_t number) const { return nodes_[number]; }
    const Leaf& leaf(std::uint32_t number) const { return leaves_[leaf_number(number)]; }
    /// The place of a leaf among all leaves.
    std::uint32_t leaf_number(std::uint32_t number) const {
        const auto slot = number - static_cast<std::uint32_t>(nodes_.size());
        return static_cast<std::uint32_t>(shape_.leaf_in(slot));
    }
    /// Each level has eight times the nodes of the one before, but for the second, which has as
    /// many as the root has children.
    std::uint32_t first_child(std::uint32_t number) const {
        return number == 0 ? 1 : arity * number + offset_;
    }

    std::span<const Leaf> leaves() const { return leaves_; }
    /// Indices of the sources, in tree order.
    std::span<const std::uint32_t> indices() const { return indices_; }

    std::size_t bytes() const {
        return leaves_.capacity() * sizeof(Leaf) + nodes_.capacity() * sizeof(Node) +
               indices_.capacity() * sizeof(std::uint32_t);
    }

    /// Nodes and leaves that a search has still to visit, the last one first.
    class Waiting {
    public:
        void add_root() { items_[size_++] = {-std::numeric_limits<double>::infinity(), 0}; }
        /// Those of eight, number(0) to number(7), whose bounds are below `limit`, the lowest last.
        template <class Numbers, class Number>
        void add(const Numbers& bounds, double limit, const Number& number) {
            const std::size_t floor = size_;
            unsigned below = 0;
            for (std::uint32_t c = 0; c < arity; ++c) below |= (bounds[c] < limit ? 1u : 0u) << c;
            for (; below != 0; below &= below - 1) {
                const auto c = static_cast<std::uint32_t>(std::countr_zero(below));
                std::size_t place = size_++;
                for (; place > floor && items_[place - 1].bound < bounds[c]; --place) {
                    items_[place] = items_[place - 1];
                }
                items_[place] = {bounds[c], number(c)};
            }
        }

    private:
        friend ConeTree;
        struct Item {
            double bound;
            std::uint32_t number;
        };
        // Seven siblings wait at each of at most eleven levels, or below two times eight.
        std::array<Item, 96> items_;
        std::size_t size_ = 0;
    };

    /// Branch and bound: calls visit_leaf(number) for the leaves, those of the lowest bounds first
    /// in each node, until a call returns false. What lies below children whose lower bound,
    /// bounds(node), is not less than limit() at the time is passed over. Returns whether no call
    /// returned false.
    template <class Limit, class Bounds, class VisitLeaf>
    bool search(const Limit& limit, const Bounds& bounds, const VisitLeaf& visit_leaf) const {
        if (empty()) return true;
        Waiting waiting;
        waiting.add_root();
        return search(waiting, limit, bounds, visit_leaf);
    }
    /// The same below those `waiting` alone.
    template <class Limit, class Bounds, class VisitLeaf>
    bool search(Waiting& waiting, const Limit& limit, const Bounds& bounds,
                const VisitLeaf& visit_leaf) const {
        while (waiting.size_ > 0) {
            const auto next = waiting.items_[--waiting.size_];
            if (next.bound >= limit()) continue;
            if (is_leaf(next.number)) {
                if (!visit_leaf(next.number)) return false;
                continue;
            }
            const std::uint32_t first = first_child(next.number);
            waiting.add(bounds(nodes_[next.number]), limit(),
                        [&](std::uint32_t c) { return first + c; });
        }
        return true;
    }

private:
    ConeTreeShape shape_;
    std::uint32_t offset_ = 0;
    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<std::uint32_t> indices_;
};

/// Builds a tree by build(items), then once more over those items of which is_dominated(item) does
/// not hold, if there are fewer. Returns their number.
template <class Build, class IsDominated>
std::size_t build_without_dominated(std::vector<ConeTreeItem>& items, const Build& build,
                                    const IsDominated& is_dominated) {
    build(items);
    std::vector<std::uint8_t> dominated(items.size());
    tbb::parallel_for(std::size_t{0}, items.size(),
                      [&](std::size_t i) { dominated[i] = is_dominated(items[i]) ? 1 : 0; });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (dominated[i] == 0) items[kept++] = items[i];
    }
    if (kept < items.size()) {
        items.resize(kept);
        build(items);
    }
    return kept;
}

}  // namespace controlspace
