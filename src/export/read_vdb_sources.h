#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sources/point_source.h"

namespace controlspace {

/// Either `h` or `per_radius` is to be given.
struct VdbSourceOptions {
    std::string grid = {};                ///< empty: the file's only one
    std::optional<double> isovalue = {};  ///< none: 0 for level sets, 0.5 for fogs
    double h = 0;                         ///< the same length everywhere
    /// Length in units of the smaller radius of curvature; from the edge of a voxel, below which
    /// the grid knows of no curvature, to half the diagonal of the grid's box.
    double per_radius = 0;
};

/// Isotropic sources on the surface of a level set or a fog (a grid of floats): one in each voxel
/// that the surface crosses.
///
/// Throws InputError that names the file for what cannot be read; for a grid that is missing, of
/// another type, empty, under a transform that is not linear, neither level set nor fog where no
/// isovalue is given, holds what is not a number, or has no surface; and for lengths out of range.
std::vector<PointSource> read_vdb_sources(const std::filesystem::path& path,
                                          const VdbSourceOptions& options);

}  // namespace controlspace
