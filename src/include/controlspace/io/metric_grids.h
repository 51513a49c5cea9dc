// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// The type of a grid's values, for programs that transform them with the grid.
enum class GridKind {
    fog,        ///< one number from 0 to 1
    number,     ///< one number
    tuple,      ///< three numbers, not rotated with the grid
    direction,  ///< a vector, rotated with the grid
};

/// A grid of an exported .vdb file, and the function from a metric to its values: one number or
/// three per voxel, since other programs read nothing else.
struct MetricGrid {
    std::string_view name;
    GridKind kind;
    std::string_view help;  ///< one line
    /// One number: in front, the others 0. `frame` is the eigen_frame of the metric.
    std::array<double, 3> (*value)(const Metric&, const EigenFrame& frame);
    /// The grid that holds the same where all metrics are isotropic.
    std::string_view isotropic_twin = {};
};

/// All of them. `density`, which Blender displays by default, comes first; its value here is the
/// smallest length, which is mapped by density_of once the range of the file is known.
std::span<const MetricGrid> metric_grids();

/// Names of the two grids that together store complete metrics.
inline constexpr std::string_view diagonal_grid = "metric_diag";
inline constexpr std::string_view off_diagonal_grid = "metric_off";
/// Name of the grid that stores complete metrics where all are isotropic.
inline constexpr std::string_view lengths_grid = "h_min";
/// Name of the grid of points.
inline constexpr std::string_view sources_grid = "sources";

/// How refined a smallest length `h` is among those from `finest` to `coarsest`, on a logarithmic
/// scale: 1 for the finest, 0 for the coarsest; 1 where all are the same.
double density_of(double h, double finest, double coarsest);

/// The inverse: finest^d coarsest^(1-d), with d clamped to [0, 1].
double length_of_density(double density, double finest, double coarsest);

}  // namespace controlspace
