// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"
#include "trees/values/quadratic_values.h"

namespace controlspace {

CatalogueEntry kd_quadratic() {
    CatalogueEntry row = tree_row<KdNode, QuadraticValues>(
        "K_Li", "kd-tree, quadratic from a leaf and its face neighbours");
    row.capabilities.push_back(QuadraticLeaves());
    return row;
}

}  // namespace controlspace
