#pragma once

#include <optional>
#include <string>

namespace controlspace {

/// What is taken out of a .vdb as sources: a surface. Either `h` or `per_radius` is to be given.
struct VdbSurface {
    std::string grid = {};                ///< level set or fog; empty: the file's only grid
    std::optional<double> isovalue = {};  ///< none: 0 for level sets, 0.5 for fogs
    double h = 0;                         ///< the same length everywhere
    /// Length in units of the smaller radius of curvature; from the edge of a voxel, below which
    /// the grid knows of no curvature, to half the diagonal of the grid's box.
    double per_radius = 0;

    bool operator==(const VdbSurface&) const = default;
};

/// How a density, somebody's painting, stands for lengths: on a logarithmic scale.
struct DensitySizes {
    double finest = 0;    ///< length at density 1
    double coarsest = 0;  ///< length at density 0, and where nothing is painted

    bool operator==(const DensitySizes&) const = default;
};

/// What is taken out of a .vdb as a field.
struct VdbLengths {
    /// A grid of one number a voxel; empty: metric_diag and metric_off.
    std::string grid = {};
    /// Takes the numbers of `grid` as densities; none: as lengths in the units of the domain.
    std::optional<DensitySizes> density = {};

    bool operator==(const VdbLengths&) const = default;
};

}  // namespace controlspace
