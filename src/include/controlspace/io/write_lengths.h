// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"
#include "controlspace/io/write_vtk.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Points at equal steps on a plane, in rows along the first of its axes.
struct Raster {
    Point origin;
    Vector spacing;
    std::array<int, 3> counts;       ///< 1 along the axis across the plane
    std::array<Axis, 2> axes{0, 1};  ///< along a row, and from row to row

    std::size_t columns() const { return count(0); }
    std::size_t rows() const { return count(1); }
    std::size_t size() const { return columns() * rows(); }
    Point at(std::size_t column, std::size_t row) const;

private:
    std::size_t count(std::size_t i) const {
        return static_cast<std::size_t>(counts[static_cast<std::size_t>(axes[i])]);
    }
};

/// Points on a slice through `domain`; those along the shorter edge have the same distance as those
/// along the longer one, or nearly. Throws InputError for a slice outside the domain, and unless
/// there are from 2 to 131072 samples.
Raster raster_of(const Box& domain, const Slice& slice);

/// Calls use(lengths) for one band of whole rows after another: the smallest lengths that `space`
/// requests there, row by row. They are computed on all of TBB's threads, in square tiles, and only
/// those of one band are in memory.
void for_each_band(const ControlSpace& space, const Raster& raster,
                   const std::function<void(std::span<const double>)>& use);

/// Called with the number of points written so far.
using RasterProgress = std::function<void(std::size_t)>;

/// Writes the smallest lengths at the points of a raster, in double precision, band by band:
///   - `.npy`: an array of NumPy of shape (rows, columns);
///   - `.vti`: an image for ParaView with data of points, `h`.
/// Throws InputError, and leaves nothing of the file, if it cannot be written; at once if the disk
/// has no room for it.
void write_lengths(const std::filesystem::path& path, const ControlSpace& space,
                   const Raster& raster, const RasterProgress& progress);

}  // namespace controlspace
