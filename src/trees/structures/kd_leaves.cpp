// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"
#include "trees/values/constant_values.h"

namespace controlspace {

CatalogueEntry kd_leaves() {
    return tree_row<KdNode, ConstantValues>("K_L", "kd-tree, a constant metric in each leaf");
}

}  // namespace controlspace
