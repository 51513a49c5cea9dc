// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "trees/structures/rows.h"

namespace controlspace {

namespace {

constexpr std::size_t anchored = 2;  // the last ones

}  // namespace

std::span<const CatalogueEntry> all_trees() {
    static const std::array trees{kd_leaves(),
                                  kd_quadratic(),
                                  kd_vertices(),
                                  octree_leaves(),
                                  balanced_octree_leaves(),
                                  octree_vertices(),
                                  octree_quadratic(),
                                  kd_sources(),
                                  octree_sources()};
    return trees;
}

std::span<const CatalogueEntry> tree_catalogue() {
    return all_trees().first(all_trees().size() - anchored);
}

std::span<const CatalogueEntry> anchored_catalogue() { return all_trees().last(anchored); }

}  // namespace controlspace
