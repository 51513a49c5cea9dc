#include "spaces/catalogue.h"

#include <fmt/format.h>

#include <array>

#include "error.h"
#include "spaces/leaf_values.h"
#include "spaces/quadratic_values.h"
#include "spaces/topology.h"
#include "spaces/tree.h"
#include "spaces/vertex_values.h"

namespace controlspace {

namespace {

template <class Node, class Storage, bool balanced = false>
std::unique_ptr<ControlSpace> make(const SpaceOptions& options) {
    require_valid(options);
    return std::make_unique<Tree<Node, Storage>>(options, balanced);
}

template <class Node, class Storage, bool balanced = false>
CatalogueEntry entry(const char* id, const char* description) {
    return {id,
            description,
            std::is_same_v<Node, KdNode>,
            Storage::exact_at_nodes,
            Storage::order,
            make<Node, Storage, balanced>};
}

void require_positive(const char* name, double value) {
    if (!std::isfinite(value) || !(value > 0)) {
        throw InputError(fmt::format("{} is {}: give a finite value above 0", name, value));
    }
}

void require_depth(const char* name, int depth, int deepest) {
    if (depth < 0 || depth > deepest) {
        throw InputError(fmt::format("{} is {}: give a value from 0 to {}", name, depth, deepest));
    }
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

void require_valid(const SpaceOptions& options) {
    require_volume(options.domain);
    require_positive("l_min (tau)", options.l_min);
    require_positive("the insertion tolerance (epsilon)", options.tolerance);
    // Past these depths a double has no number left between the faces of any box.
    require_depth("the depth of kd-trees", options.kd_depth, 200);
    require_depth("the depth of octrees", options.octree_depth, 60);
}

}  // namespace controlspace
