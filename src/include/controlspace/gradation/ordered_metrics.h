// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// The metrics of a graph's nodes, in the memory and the order of their owner.
class OrderedMetrics {
public:
    OrderedMetrics(std::vector<Metric>& metrics) : metrics_(metrics) {}
    /// That of node i is metrics[order[i]]; without an order, metrics[i].
    OrderedMetrics(std::span<Metric> metrics, std::span<const NodeIndex> order = {})
        : metrics_(metrics), order_(order) {}

    std::size_t size() const { return metrics_.size(); }
    Metric& operator[](std::size_t node) const {
        return metrics_[order_.empty() ? node : order_[node]];
    }
    /// All of them, in no particular order.
    std::span<const Metric> all() const { return metrics_; }

private:
    std::span<Metric> metrics_;
    std::span<const NodeIndex> order_;
};

}  // namespace controlspace
