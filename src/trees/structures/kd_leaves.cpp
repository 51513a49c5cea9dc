// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/leaf_metrics.h"
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"

namespace controlspace {

CatalogueEntry kd_leaves() {
    return tree_row<KdNode, LeafMetrics>("K_L", "kd-tree, a constant metric in each leaf");
}

}  // namespace controlspace
