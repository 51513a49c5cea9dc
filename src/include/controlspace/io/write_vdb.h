// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

enum class VdbCompression { blosc, zip, none };

/// Metadata of each grid: a name and a number or a text.
using VdbNote = std::pair<std::string, std::variant<double, std::string>>;

struct VdbOptions {
    double voxel = 0;  ///< edge [length]; 0: 1/128 of the domain's longest edge
    /// Relative difference of lengths, in any direction, up to which voxels share a metric; 0: only
    /// equal metrics.
    double tolerance = 0.01;
    bool half = false;  ///< numbers of 16 bits in the file
    VdbCompression compression = VdbCompression::blosc;
    std::vector<std::string> grids = {};  ///< names of metric_grids(); none: see below
    std::vector<VdbNote> notes = {};
    /// Written as a grid of points `sources`, with the attributes pscale (the smallest length,
    /// which Houdini draws), metric_diag and metric_off; none: no such grid. Blender 3.4 lists it,
    /// but draws no points.
    std::vector<PointSource> sources = {};
    std::size_t max_bytes = std::size_t{4} << 30;  ///< cap on the memory of the grids
    /// Called, by one thread at a time, with the number of voxels sampled so far; may be empty.
    std::function<void(std::size_t done, std::size_t all)> progress = {};
};

/// What was written.
struct VdbReport {
    double voxel = 0;                      ///< edge [length]
    double scale = 1;                      ///< of places and lengths in the file
    std::array<std::int32_t, 3> counts{};  ///< voxels along x, y, z
    double finest = 0, coarsest = 0;       ///< of the smallest length
    double kept = 0;          ///< share of voxels stored in leaves rather than in tiles of 8^3
    std::size_t memory = 0;   ///< bytes of all grids
    std::uintmax_t file = 0;  ///< bytes
};

/// Samples `field` over `domain` at the centres of cubic voxels and writes metric_grids() to the
/// .vdb file `path`, in the units of the domain; tensors are M, whose eigenvalues are lengths.
/// OpenVDB has no voxels below some 1e-5: of smaller ones places and lengths are multiplied by a
/// power of ten, the metadatum `scale` of each grid, which read_vdb_field divides by.
/// Unless grids are named, all are written, or, where all metrics are isotropic, density and h_min.
/// The lengths of every active voxel are those of the field at its centre within a factor of
/// 1 + tolerance; 8^3 voxels that share a metric become a tile. Runs on all of TBB's threads; the
/// grids do not depend on their number.
///
/// Throws InputError for options out of range, unknown names of grids, a field that is
/// no metric somewhere, lengths that the file's numbers cannot hold, grids beyond the cap, and a
/// file that cannot be written, of which nothing is left.
VdbReport write_vdb(const std::filesystem::path& path, const ControlSpace& field, const Box& domain,
                    const VdbOptions& options);

/// The same for `space` over its own domain.
VdbReport write_vdb(const std::filesystem::path& path, const ControlSpace& space,
                    const VdbOptions& options);

}  // namespace controlspace
