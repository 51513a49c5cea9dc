// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "controlspace/gradation/node_graph.h"
#include "controlspace/space/space_options.h"
#include "controlspace/trees/node_metrics.h"
#include "controlspace/trees/topology.h"

namespace controlspace {

/// The simplest storage (storage.h): one metric a leaf, constant over it (K_L, K_oL); the control
/// node is the leaf's centre. A base for storages that keep more beside the metric.
class LeafMetrics {
public:
    static constexpr int order = 0;
    static constexpr CutBy cut_by = CutBy::corners;
    using constant_leaves = LeafMetrics;

    explicit LeafMetrics(const SpaceOptions& options) : metrics_(1, largest_metric(options)) {}

    NodeMetrics& metrics() { return metrics_; }
    const NodeMetrics& metrics() const { return metrics_; }
    static std::array<NodeIndex, 1> nodes_of(LeafIndex leaf) { return {leaf}; }

    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) {
        metrics_.repeat(leaf, static_cast<std::size_t>(subdivision.children() - 1));
    }
    template <class Node, class M>
    M value_in(const Topology<Node>&, LeafIndex leaf, const Point&,
               const NodeView<M>& nodes) const {
        return nodes[leaf];
    }

protected:
    NodeMetrics metrics_;
};

}  // namespace controlspace
