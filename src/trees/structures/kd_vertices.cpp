// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"
#include "trees/structures/rows.h"
#include "trees/values/vertex_values.h"

namespace controlspace {

CatalogueEntry kd_vertices() {
    return tree_row<KdNode, VertexValues>("K_V",
                                          "kd-tree, trilinear between the vertices of a leaf");
}

}  // namespace controlspace
