// SPDX-License-Identifier: Apache-2.0
#include "trees/source_tree.h"
#include "trees/structures/rows.h"

namespace controlspace {

CatalogueEntry kd_sources() {
    return source_row<KdNode>("K_LA", "kd-tree, the few sources that matter in each leaf");
}

}  // namespace controlspace
