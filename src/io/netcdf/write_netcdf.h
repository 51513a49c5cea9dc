// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/io/write_lengths.h"

namespace controlspace {

/// The smallest lengths at the points of a raster as a netCDF file (.nc, 64-bit data): the variable
/// `h` over the coordinates of its two axes. Throws as write_lengths.
void write_netcdf(const std::filesystem::path& path, const ControlSpace& space,
                  const Raster& raster, const RasterProgress& progress);

}  // namespace controlspace
