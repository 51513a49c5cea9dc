// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"
#include "trees/values/vertex_values.h"

namespace controlspace {

CatalogueEntry octree_vertices() {
    return tree_row<OctreeNode, VertexValues>("K_oV",
                                              "octree, trilinear between the vertices of a leaf");
}

}  // namespace controlspace
