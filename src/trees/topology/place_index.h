// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/geometry/point.h"
#include "controlspace/gradation/node_graph.h"

namespace controlspace {

/// Finds control nodes by their exact coordinates: an open-addressing hash table of node numbers,
/// half full at most. The positions stay with the owner, who passes them along.
class PlaceIndex {
public:
    PlaceIndex() = default;
    /// Of places that all differ.
    explicit PlaceIndex(std::span<const Point> positions);

    /// The node at `x`. If there is none: `next`, which is entered for it; the owner must then
    /// append `x` to its positions as number `next` before the next call.
    NodeIndex find_or_enter(const Point& x, NodeIndex next, std::span<const Point> positions);

    /// Asks memory for what a search for `x` reads first; and the node that it compares with first,
    /// or a number beyond all nodes.
    void prefetch(const Point& x) const;
    NodeIndex likely_at(const Point& x) const;

    bool is_empty() const { return used_ == 0; }
    std::size_t bytes() const { return table_.capacity() * sizeof(NodeIndex); }

private:
    void grow(std::span<const Point> positions);
    void enter_all(std::size_t slots, std::span<const Point> positions);
    std::size_t slot_of(const Point& x, std::span<const Point> positions) const;

    std::vector<NodeIndex> table_;
    std::size_t used_ = 0;
};

/// Numbers places, equal ones alike, by the order in which they come first, on all of TBB's
/// threads. Appends those that differ to `distinct`; a place whose x is NaN gets some number.
std::vector<NodeIndex> number_places(std::span<const Point> x, std::vector<Point>& distinct);

}  // namespace controlspace
