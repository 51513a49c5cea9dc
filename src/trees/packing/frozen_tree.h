#pragma once

#include <memory>
#include <span>

#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/space_options.h"
#include "trees/topology/corners.h"
#include "trees/topology/topology.h"

namespace controlspace {

// Compact forms of trees, which can only be read (BuildOptions::precision): nodes and leaves lie
// depth first, and only what reading needs is kept. With doubles they answer as the tree does, to
// the bit. For KdNode and OctreeNode. All throw InputError where floats cannot hold a metric.

/// One metric a leaf, constant over it.
template <class Node>
std::unique_ptr<ControlSpace> freeze_leaves(const Topology<Node>& tree,
                                            std::span<const Metric> metrics, Precision precision);

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
