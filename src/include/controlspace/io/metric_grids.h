#pragma once

#include <array>
#include <span>
#include <string_view>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// What the three numbers of a grid are, for programs that transform them with the grid.
enum class GridKind {
    fog,        ///< one number from 0 to 1
    number,     ///< one number
    tuple,      ///< three numbers that do not turn with the grid
    direction,  ///< a vector that does
};

/// A grid of an exported .vdb file, and how its values follow from a metric. Only one number or
/// three a voxel, since other programs read nothing else.
struct MetricGrid {
    std::string_view name;
    GridKind kind;
    std::string_view help;  ///< one line
    /// One number: in front, the others 0. `frame` is the eigen_frame of the metric.
    std::array<double, 3> (*value)(const Metric&, const EigenFrame& frame);
    /// The grid that holds the same where all metrics are isotropic.
    std::string_view isotropic_twin = {};
};

/// All of them. `density`, which Blender shows unasked, comes first; its value here is the smallest
/// length, which the whole file's lengths turn into density_of.
std::span<const MetricGrid> metric_grids();

/// Names of the two grids that hold a metric whole.
inline constexpr std::string_view diagonal_grid = "metric_diag";
inline constexpr std::string_view off_diagonal_grid = "metric_off";
/// Name of the grid of points.
inline constexpr std::string_view sources_grid = "sources";

/// How refined a smallest length `h` is among those from `finest` to `coarsest`, on a logarithmic
/// scale: 1 for the finest, 0 for the coarsest; 1 where all are the same.
double density_of(double h, double finest, double coarsest);

/// The way back: finest^d coarsest^(1-d), for d from 0 to 1; beyond them as at the nearer one.
double length_of_density(double density, double finest, double coarsest);

}  // namespace controlspace
