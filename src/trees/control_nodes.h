// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "controlspace/gradation/grade.h"
#include "controlspace/gradation/law.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/trees/leaf_model.h"
#include "space/given_sources.h"
#include "trees/topology/topology.h"

namespace controlspace {

// What is done with the control nodes of a tree, wherever they stand: once for all models.

/// In the order of the tree's leaves, depth first, or of the vertices' numbers.
template <class Node>
ControlNodes nodes_of_tree(const Topology<Node>& tree, const LeafModel<Node>& model,
                           Neighbourhood neighbourhood);

/// The largest gradation ratio of the control nodes.
template <class Node>
double largest_gradation_of_tree(const Topology<Node>& tree, const LeafModel<Node>& model,
                                 Neighbourhood neighbourhood, GradationLaw law);

/// In the order of nodes_of_tree. Throws InputError for a wrong number.
template <class Node>
void assign_nodes(const Topology<Node>& tree, LeafModel<Node>& model,
                  std::span<const Metric> metrics);

template <class Node>
GradationReport grade_nodes(const Topology<Node>& tree, LeafModel<Node>& model,
                            const NodeGradation& gradation);

}  // namespace controlspace
