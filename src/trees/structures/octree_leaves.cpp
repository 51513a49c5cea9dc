#include "trees/structures/rows.h"
#include "trees/tree_row.h"
#include "trees/values/leaf_values.h"

namespace controlspace {

CatalogueEntry octree_leaves() {
    return tree_row<OctreeNode, LeafValues>("K_oL", "octree, a constant metric in each leaf");
}

CatalogueEntry balanced_octree_leaves() {
    return tree_row<OctreeNode, LeafValues, true>("K_oLB",
                                                  "as K_oL, balanced 2:1 over the faces of leaves");
}

}  // namespace controlspace
