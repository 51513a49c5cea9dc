// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "controlspace/space/catalogue.h"
#include "controlspace/trees/leaf_model.h"

namespace controlspace {

template <class Node>
using MakeLeafModel = std::unique_ptr<LeafModel<Node>> (*)(const SpaceOptions&);

/// A builder of a tree whose leaves hold that model: for KdNode and OctreeNode. With `balanced`,
/// leaves with a common face differ by one level at most (octrees).
template <class Node>
std::unique_ptr<ControlSpaceBuilder> make_tree(const SpaceOptions& options,
                                               MakeLeafModel<Node> model, bool balanced);

/// What every such row has in common, its `construct` left out.
template <class Node>
CatalogueEntry tree_entry(const char* id, const char* description, const ModelTraits& traits);

/// The catalogue's row of a tree: `Node` is how it is cut, KdNode or OctreeNode, `Model` what
/// leaves hold, a LeafModel<Node> with a constructor from SpaceOptions and its ModelTraits as a
/// constant `model_traits`. `id` and `description` are those of CatalogueEntry.
template <class Node, template <class> class Model, bool balanced = false>
CatalogueEntry tree_row(const char* id, const char* description) {
    CatalogueEntry row = tree_entry<Node>(id, description, Model<Node>::model_traits);
    row.construct = [](const SpaceOptions& options) {
        return make_tree<Node>(
            options,
            [](const SpaceOptions& of) -> std::unique_ptr<LeafModel<Node>> {
                return std::make_unique<Model<Node>>(of);
            },
            balanced);
    };
    return row;
}

}  // namespace controlspace
