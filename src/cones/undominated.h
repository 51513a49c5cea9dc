// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cones/tensor_tree.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Sources without those that change an intersection of their cones nowhere, in a tree.
struct UndominatedSources {
    TensorTree tree;
    std::vector<ConeTreeItem> items;  ///< of the tree, in its order
    std::vector<double> lengths;      ///< the smallest of each source given
    double uncertainty = 0;           ///< relative, of lengths computed from the metrics given
    std::size_t dropped = 0;          ///< sources left out
};

/// g >= 1, the ratio of sources that have none. Lengths of `cap` or more do not matter. Runs on all
/// of TBB's threads. The tree does not depend on the order of the sources.
UndominatedSources undominated_sources(std::span<const PointSource> sources, double g, double cap);

/// Factors of the cones of a leaf's sources at `p`.
Lanes cone_factors(const TensorLeaf& leaf, const Point& p);

/// Lower bounds of the factors of all cones below each child of a node.
Lanes least_cone_factors(const TensorNode& node, double uncertainty, const Point& p);

}  // namespace controlspace
