// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace controlspace {

/// A point of the domain, and the displacement between two points, in the user's unit of length.
using Point = Eigen::Vector3d;
using Vector = Eigen::Vector3d;

/// Index of a coordinate axis: 0 = x, 1 = y, 2 = z.
using Axis = int;

/// Largest magnitude of an input number, and the inverse of the smallest length: beyond it, squares
/// of squares leave the range of double.
inline constexpr double largest_magnitude = 1e50;

}  // namespace controlspace
