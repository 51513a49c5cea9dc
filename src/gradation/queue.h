#pragma once

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/gradation/ordered_metrics.h"

namespace controlspace {

/// One node's turn: applies the law to it and its neighbours, and calls changed(node) for each
/// metric made smaller.
template <class Graph, class Changed>
void take_turn(const Graph& graph, OrderedMetrics metrics, GradationLaw law, double g, NodeIndex i,
               Changed&& changed) {
    graph.for_each_link(i, [&](NodeIndex j, const Vector& v) {
        const Limited limited = limit_growth(law, g, v, metrics[i], metrics[j]);
        if (limited.first) changed(i);
        if (limited.second) changed(j);
    });
}

/// First in, first out; every node is in it at most once, so a ring of as many places as nodes
/// never overflows.
class NodeQueue {
public:
    /// All of `nodes` nodes, in order.
    explicit NodeQueue(std::size_t nodes) : ring_(nodes), waits_(nodes, 1), size_(nodes) {
        std::iota(ring_.begin(), ring_.end(), NodeIndex{0});
    }
    /// Some of `nodes` nodes, in the order given, each once.
    NodeQueue(std::size_t nodes, std::span<const NodeIndex> some)
        : ring_(nodes), waits_(nodes, 0), size_(0) {
        for (const NodeIndex node : some) push(node);
    }
    bool empty() const { return size_ == 0; }
    NodeIndex pop() {
        const NodeIndex node = take();
        let_return(node);
        return node;
    }
    /// The same in two steps: the node is the next one; from now on it may be pushed again.
    NodeIndex take() {
        const NodeIndex node = ring_[head_];
        head_ = next(head_);
        --size_;
        return node;
    }
    void let_return(NodeIndex node) { waits_[node] = 0; }
    std::size_t size() const { return size_; }
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

/// The queue schedule (paper §3.2): applies the law to every node and its neighbours, and again to
/// those that changed, until nothing changes. Returns the number of metrics made smaller.
template <class Graph>
std::uint64_t grade_by_queue(const Graph& graph, OrderedMetrics metrics, GradationLaw law,
                             double g) {
    std::uint64_t operations = 0;
    NodeQueue queue(graph.size());
    while (!queue.empty()) {
        take_turn(graph, metrics, law, g, queue.pop(), [&](NodeIndex changed) {
            ++operations;
            queue.push(changed);
        });
    }
    return operations;
}

}  // namespace controlspace
