#pragma once

#include <Eigen/Core>

namespace controlspace {

/// A place in the domain, or a displacement between two places, in the user's length unit.
using Point = Eigen::Vector3d;
using Vector = Eigen::Vector3d;

/// Index of a coordinate axis: 0 = x, 1 = y, 2 = z.
using Axis = int;

}  // namespace controlspace
