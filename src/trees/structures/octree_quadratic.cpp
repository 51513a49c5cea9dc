// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"
#include "trees/values/quadratic_values.h"

namespace controlspace {

CatalogueEntry octree_quadratic() {
    CatalogueEntry row = tree_row<OctreeNode, QuadraticValues>(
        "K_oLi", "octree, quadratic from a leaf and its face neighbours");
    row.family = "further";
    row.capabilities.push_back(QuadraticLeaves());
    return row;
}

}  // namespace controlspace
