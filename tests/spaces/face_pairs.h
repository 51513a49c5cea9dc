// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trees/topology/face_pairs.h"

namespace controlspace {

/// Calls visit(low leaf, high leaf) for all pairs of a tree (FacePairs).
template <class Node, class Visit>
void for_each_face_pair(const Topology<Node>& tree, Visit&& visit) {
    FacePairs<Node, Visit>(tree, visit).within({tree.root(), tree.domain()});
}

}  // namespace controlspace
