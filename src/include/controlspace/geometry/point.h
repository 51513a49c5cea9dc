#pragma once

#include <Eigen/Core>

namespace controlspace {

/// A place in the domain, or a displacement between two places, in the user's length unit.
using Point = Eigen::Vector3d;
using Vector = Eigen::Vector3d;

/// Index of a coordinate axis: 0 = x, 1 = y, 2 = z.
using Axis = int;

/// Largest magnitude of a number that is taken from a user, and the inverse of the smallest length:
/// beyond it, squares of squares leave the range of double.
inline constexpr double largest_magnitude = 1e50;

}  // namespace controlspace
