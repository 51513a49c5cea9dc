#include "controlspace/space/catalogue.h"

#include <algorithm>
#include <array>

#include "trees/topology/topology.h"
#include "trees/tree.h"
#include "trees/values/anchored_values.h"
#include "trees/values/leaf_values.h"
#include "trees/values/quadratic_values.h"
#include "trees/values/vertex_values.h"

namespace controlspace {

namespace {

template <class Node, class Storage, bool balanced = false>
std::unique_ptr<ControlSpace> make(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<Tree<Node, Storage>>(options, balanced);
}

template <class Node, class Storage, bool balanced = false>
CatalogueEntry entry(const char* id, const char* description) {
    CatalogueEntry entry;
    entry.id = id;
    entry.description = description;
    entry.has_split_rules = std::is_same_v<Node, KdNode>;
    entry.exact_at_nodes = Storage::exact_at_nodes;
    entry.order = Storage::order;
    entry.construct = make<Node, Storage, balanced>;
    entry.takes_metrics = !std::is_same_v<Storage, AnchoredValues>;
    entry.can_freeze = entry.takes_metrics;
    entry.group = entry.takes_metrics ? "trees" : "anchored";
    return entry;
}

}  // namespace

std::unique_ptr<ControlSpace> CatalogueEntry::make(const SpaceOptions& options) const {
    auto space = construct(options);
    space->set_making({id, options});
    return space;
}

const CatalogueEntry* find_entry(std::span<const CatalogueEntry> entries, std::string_view id) {
    const auto named = [&](const CatalogueEntry& entry) {
        return entry.id == id || (!id.empty() && entry.former_id == id);
    };
    const auto found = std::find_if(entries.begin(), entries.end(), named);
    return found == entries.end() ? nullptr : &*found;
}

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
