#include "controlspace/space/catalogue.h"

#include <array>

#include "space/shared_builder.h"
#include "trees/topology/topology.h"
#include "trees/tree_data.h"
#include "trees/values/anchored_values.h"
#include "trees/values/leaf_values.h"
#include "trees/values/quadratic_values.h"
#include "trees/values/vertex_values.h"

namespace controlspace {

namespace {

template <class Node, class Storage, bool balanced = false>
std::unique_ptr<ControlSpaceBuilder> construct(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<SharedBuilder<TreeData<Node, Storage>>>(options, balanced);
}

template <class Node, class Storage, bool balanced = false>
CatalogueEntry entry(const char* id, const char* description) {
    CatalogueEntry entry{.id = id,
                         .description = description,
                         .family = "trees",
                         .order = Storage::order,
                         .construct = construct<Node, Storage, balanced>,
                         .capabilities = {SourceLeaves()}};
    if (std::is_same_v<Node, KdNode>) entry.capabilities.push_back(SplitRules());
    if (std::is_same_v<Storage, AnchoredValues>) {
        entry.family = "anchored";
        entry.capabilities.push_back(KeptSources());
    } else {
        entry.capabilities.push_back(MetricNodes());
        entry.capabilities.push_back(CompactForm());
    }
    return entry;
}

}  // namespace

std::span<const CatalogueEntry> tree_catalogue() {
    static const std::array<CatalogueEntry, 6> trees{
        entry<KdNode, LeafValues>("K_L", "kd-tree, a constant metric in each leaf"),
        entry<KdNode, QuadraticValues>("K_Li",
                                       "kd-tree, quadratic from a leaf and its face neighbours"),
        entry<KdNode, VertexValues>("K_V", "kd-tree, trilinear between the vertices of a leaf"),
        entry<OctreeNode, LeafValues>("K_oL", "octree, a constant metric in each leaf"),
        entry<OctreeNode, LeafValues, true>("K_oLB",
                                            "as K_oL, balanced 2:1 over the faces of leaves"),
        entry<OctreeNode, VertexValues>("K_oV", "octree, trilinear between the vertices of a leaf"),
    };
    return trees;
}

std::span<const CatalogueEntry> anchored_catalogue() {
    static const std::array<CatalogueEntry, 2> trees{
        entry<KdNode, AnchoredValues>("K_LA", "kd-tree, up to three sources in each leaf"),
        entry<OctreeNode, AnchoredValues>("K_oLA", "octree, up to three sources in each leaf"),
    };
    return trees;
}

}  // namespace controlspace
