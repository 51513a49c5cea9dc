// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "controlspace/space/catalogue.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/trees/detail/metric_tree.h"

namespace controlspace {

/// The catalogue's row of a tree whose control nodes carry metrics: `Node` is the cut, KdNode or
/// OctreeNode (cut.h), `Storage` what leaves hold (storage.h). With `balanced`, leaves with a
/// common face differ by one level at most. `id` and `description` are those of CatalogueEntry.
///
/// Instantiates all algorithms of the tree: best in a source file of its own.
template <class Node, class Storage, bool balanced = false>
CatalogueEntry tree_row(const char* id, const char* description) {
    check_cut<Node>();
    check_node_storage<Node, Storage>();
    CatalogueEntry row{
        .id = id,
        .description = description,
        .family = "trees",
        .order = Storage::order,
        .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
            require_valid(options);
            using Data = MetricTree<Node, Storage>;
            return std::make_unique<SharedBuilder<Data>>(options, balanced);
        },
        .capabilities = {SourceLeaves(), MetricNodes(), CompactForm()}};
    if (Node::arity == 2) row.capabilities.push_back(SplitRules());
    return row;
}

}  // namespace controlspace
