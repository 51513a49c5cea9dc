// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "controlspace/gradation/node_graph.h"

namespace controlspace {

/// First in, first out; every node is in it at most once, so a ring with as many slots as nodes
/// never overflows.
class NodeQueue {
public:
    /// All of `nodes` nodes, in order.
    explicit NodeQueue(std::size_t nodes) : ring_(nodes), waits_(nodes, 1), size_(nodes) {
        std::iota(ring_.begin(), ring_.end(), NodeIndex{0});
    }
    bool empty() const { return size_ == 0; }
    std::size_t size() const { return size_; }
    /// Removes the first node. It can be pushed again after let_return only.
    NodeIndex take() {
        const NodeIndex node = ring_[head_];
        head_ = next(head_);
        --size_;
        return node;
    }
    void let_return(NodeIndex node) { waits_[node] = 0; }
    /// Without effect on a node that waits already.
    void push(NodeIndex node) {
        if (waits_[node] != 0) return;
        waits_[node] = 1;
        ring_[tail_] = node;
        tail_ = next(tail_);
        ++size_;
    }

private:
    std::size_t next(std::size_t i) const { return i + 1 == ring_.size() ? 0 : i + 1; }

    std::vector<NodeIndex> ring_;
    std::vector<std::uint8_t> waits_;
    std::size_t head_ = 0, tail_ = 0, size_;
};

}  // namespace controlspace
