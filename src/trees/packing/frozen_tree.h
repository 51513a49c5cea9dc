// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/space_options.h"
#include "trees/topology/corners.h"
#include "trees/topology/topology.h"

namespace controlspace {

// Compact forms (packed_tree.h) of models whose queries need the boxes of leaves: these are kept
// as numbers of planes. For KdNode and OctreeNode.

/// How QuadraticValues interpolates.
struct QuadraticRule {
    double slope = 0;  ///< g_r - 1
    QuadraticForm form = QuadraticForm::corrected;
};

/// One metric a leaf, interpolated as QuadraticValues does.
template <class Node>
std::unique_ptr<ControlSpace> freeze_quadratic(const Topology<Node>& tree,
                                               std::span<const Metric> metrics,
                                               const QuadraticRule& rule, Precision precision);

/// A metric a vertex; `corners` are the numbers of the leaves' vertices.
template <class Node>
std::unique_ptr<ControlSpace> freeze_vertices(const Topology<Node>& tree,
                                              std::span<const Corners> corners,
                                              std::span<const Metric> metrics, Precision precision);

}  // namespace controlspace
