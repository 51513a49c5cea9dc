// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "cones/cone_tree.h"
#include "controlspace/sources/point_source.h"
#include "metric/tensor_lanes.h"

namespace controlspace {

/// Bounds of all sources below each child, for `AnisotropicCones` (which states what follows from
/// them).
struct TensorNode {
    VectorLanes centre;
    Lanes radius = Lanes::Zero();  ///< largest |inverse (Q_i - centre)|
    TensorLanes inverse;           ///< no displacement v is shorter in M_i than |inverse v|
    TensorLanes square;            ///< L^2, where L is within all M_i
    /// Smallest of all M_i; infinite where there is no child.
    Lanes length = Lanes::Constant(std::numeric_limits<double>::infinity());
    Lanes growth = Lanes::Ones();  ///< smallest ratio of the sources' cones
};

/// Eight sources side by side.
struct TensorLeaf {
    VectorLanes position;
    TensorLanes metric;
    Lanes length;  ///< smallest of the metric; infinite where there is no source
    Lanes growth;  ///< ratio of the cone

    PointSource operator[](Eigen::Index lane) const {
        return {position[lane], metric[lane], growth[lane]};
    }
};

using TensorTree = ConeTree<TensorNode, TensorLeaf>;

/// M^-1.
Metric inverse(const Metric& m);

/// Builds a tree over `items`, which are put in order. `lengths` are the smallest of each source.
TensorTree build_tensor_tree(std::span<ConeTreeItem> items, std::span<const PointSource> sources,
                             std::span<const double> lengths, double g);

}  // namespace controlspace
