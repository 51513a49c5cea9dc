#include "trees/structures/rows.h"
#include "trees/tree_row.h"
#include "trees/values/quadratic_values.h"

namespace controlspace {

CatalogueEntry octree_quadratic() {
    return tree_row<OctreeNode, QuadraticValues>(
        "K_oLi", "octree, quadratic from a leaf and its face neighbours");
}

}  // namespace controlspace
