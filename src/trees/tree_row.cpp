// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/tree_row.h"

#include "space/shared_builder.h"
#include "trees/metric_tree.h"

namespace controlspace {

template <class Node>
std::unique_ptr<ControlSpaceBuilder> make_tree(const SpaceOptions& options,
                                               MakeLeafModel<Node> model, bool balanced) {
    require_valid(options);
    return std::make_unique<SharedBuilder<MetricTree<Node>>>(options, model, balanced);
}

template <class Node>
CatalogueEntry tree_entry(const char* id, const char* description, const ModelTraits& traits) {
    CatalogueEntry row{.id = id,
                       .description = description,
                       .family = "trees",
                       .order = traits.order,
                       .capabilities = {SourceLeaves(), MetricNodes(), CompactForm()}};
    if (Node::arity == 2) row.capabilities.push_back(SplitRules());
    if (traits.is_trilinear) row.capabilities.push_back(FittedValues());
    return row;
}

template std::unique_ptr<ControlSpaceBuilder> make_tree<KdNode>(const SpaceOptions&,
                                                                MakeLeafModel<KdNode>, bool);
template std::unique_ptr<ControlSpaceBuilder> make_tree<OctreeNode>(const SpaceOptions&,
                                                                    MakeLeafModel<OctreeNode>,
                                                                    bool);
template CatalogueEntry tree_entry<KdNode>(const char*, const char*, const ModelTraits&);
template CatalogueEntry tree_entry<OctreeNode>(const char*, const char*, const ModelTraits&);

}  // namespace controlspace
