#include "trees/structures/rows.h"
#include "trees/tree_row.h"
#include "trees/values/leaf_values.h"

namespace controlspace {

CatalogueEntry kd_leaves() {
    return tree_row<KdNode, LeafValues>("K_L", "kd-tree, a constant metric in each leaf");
}

}  // namespace controlspace
