// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "controlspace/fields/analytic_field.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

// Reading of OpenVDB's files (.vdb), in the units of the grid's transform.
//
// Both readers throw InputError that names the file for what cannot be read; for a grid that is
// missing (with a list of what is there), of another type, empty, or under a transform that is not
// linear; and for voxels whose values cannot be used.
//
// OpenVDB does not validate files: a damaged one may crash it or exhaust memory. For files of
// unknown origin call require_readable first (controlspace/io/require_readable.h).

/// How a surface in a .vdb file becomes sources. Exactly one of `h` and `per_radius` is given.
struct VdbSurface {
    std::string grid = {};                ///< level set or fog; empty: the file's only grid
    std::optional<double> isovalue = {};  ///< none: 0 for level sets, 0.5 for fogs
    double h = 0;                         ///< the same length everywhere
    /// Length in units of the smaller radius of curvature; at least the edge of a voxel, below
    /// which the grid has no curvature, at most half the diagonal of the grid's box.
    double per_radius = 0;

    bool operator==(const VdbSurface&) const = default;
};

/// Isotropic sources on the surface of a level set or a fog (a grid of floats): one in each voxel
/// that the surface crosses. Throws InputError, too, where no isovalue is given for a grid that is
/// neither, where the grid has no surface, and for lengths out of range.
std::vector<PointSource> read_vdb_sources(const std::filesystem::path& path,
                                          const VdbSurface& surface);

/// Maps a painted density to lengths, logarithmically.
struct DensitySizes {
    double finest = 0;    ///< length at density 1
    double coarsest = 0;  ///< length at density 0, and where nothing is painted

    bool operator==(const DensitySizes&) const = default;
};

/// The grids of a .vdb file that define a field, and the meaning of their values.
struct VdbLengths {
    /// A grid of one number a voxel; empty: metric_diag (xx yy zz) and metric_off (xy xz yz), the
    /// tensor M of lengths, not M^-2, or the lengths that write_vdb wrote in their place.
    std::string grid = {};
    /// The numbers of `grid` are densities; none: they are lengths.
    std::optional<DensitySizes> density = {};

    bool operator==(const VdbLengths&) const = default;
};

/// The field that write_vdb wrote, or that another program's lengths or densities define. Between
/// the voxels' centres the eight around a point are blended, linear in M; inactive ones do not
/// count. Where none of them is active the length is the coarsest of the file (of `density`). The
/// field is defined in the box of the active voxels; points outside are answered as its nearest
/// point. Throws InputError, too, for voxels that are not a number, not positive (lengths), or not
/// positive definite.
AnalyticField read_vdb_field(const std::filesystem::path& path, const VdbLengths& what = {});

}  // namespace controlspace
