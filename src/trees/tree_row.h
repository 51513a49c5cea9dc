#pragma once

#include <memory>

#include "controlspace/space/catalogue.h"
#include "space/shared_builder.h"
#include "trees/metric_tree.h"

namespace controlspace {

/// The catalogue's row of a tree whose control nodes carry metrics. Each is instantiated in a file
/// of its own (trees/structures).
template <class Node, class Storage, bool balanced = false>
CatalogueEntry tree_row(const char* id, const char* description) {
    check_node_storage<Storage>();
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
