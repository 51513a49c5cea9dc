// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "controlspace/gradation/law.h"
#include "controlspace/gradation/node_graph.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Control nodes with their metrics, detached from the structure that they came from.
struct ControlNodes {
    ControlGraph graph;
    std::vector<Metric> metrics;
};

/// What has control nodes: finished trees and grids, and builders of those that store metrics.
class HasControlNodes {
public:
    virtual ~HasControlNodes() = default;

    /// Control nodes in the structure's own order (leaves of trees: depth first). Of structures
    /// that keep sources: the centres of leaves, or the sources' places, with the metric there.
    virtual ControlNodes control_nodes(Neighbourhood neighbourhood) const = 0;
    /// The largest gradation ratio of the nodes under a law (controlspace/gradation/grade.h).
    virtual double largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const;
};

/// The control nodes of a finished structure; none of a field.
std::optional<ControlNodes> control_nodes(const ControlSpace& space, Neighbourhood neighbourhood);
/// The largest gradation ratio of the control nodes; none of a field.
std::optional<double> largest_gradation(const ControlSpace& space, Neighbourhood neighbourhood,
                                        GradationLaw law);

}  // namespace controlspace
