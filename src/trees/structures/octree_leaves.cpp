// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"
#include "trees/values/constant_values.h"

namespace controlspace {

CatalogueEntry octree_leaves() {
    return tree_row<OctreeNode, ConstantValues>("K_oL", "octree, a constant metric in each leaf");
}

CatalogueEntry balanced_octree_leaves() {
    return tree_row<OctreeNode, ConstantValues, true>(
        "K_oLB", "as K_oL, balanced 2:1 over the faces of leaves");
}

}  // namespace controlspace
