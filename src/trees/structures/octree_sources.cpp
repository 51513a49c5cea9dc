// SPDX-License-Identifier: Apache-2.0
#include "trees/source_tree.h"
#include "trees/structures/rows.h"

namespace controlspace {

CatalogueEntry octree_sources() {
    return source_row<OctreeNode>("K_oLA", "octree, the few sources that matter in each leaf");
}

}  // namespace controlspace
