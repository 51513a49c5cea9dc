#include <array>

#include "trees/structures/rows.h"

namespace controlspace {

std::span<const CatalogueEntry> tree_catalogue() {
    static const std::array trees{kd_leaves(),       kd_quadratic(),           kd_vertices(),
                                  octree_leaves(),   balanced_octree_leaves(), octree_vertices(),
                                  octree_quadratic()};
    return trees;
}

std::span<const CatalogueEntry> anchored_catalogue() {
    static const std::array trees{kd_sources(), octree_sources()};
    return trees;
}

}  // namespace controlspace
