// SPDX-License-Identifier: Apache-2.0
#include "trees/source_tree.h"
#include "trees/structures/rows.h"

namespace controlspace {

namespace {

template <class Node>
CatalogueEntry source_row(const char* id, const char* description) {
    CatalogueEntry row{.id = id,
                       .description = description,
                       .family = "anchored",
                       .construct = make_source_tree<Node>,
                       .capabilities = {SourceLeaves(), KeptSources()}};
    if (Node::arity == 2) row.capabilities.push_back(SplitRules());
    return row;
}

}  // namespace

CatalogueEntry kd_sources() {
    return source_row<KdNode>("K_LA", "kd-tree, the few sources that matter in each leaf");
}

CatalogueEntry octree_sources() {
    return source_row<OctreeNode>("K_oLA", "octree, the few sources that matter in each leaf");
}

}  // namespace controlspace
