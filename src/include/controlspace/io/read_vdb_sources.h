#pragma once

#include <filesystem>
#include <vector>

#include "controlspace/io/vdb_choice.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Isotropic sources on the surface of a level set or a fog (a grid of floats): one in each voxel
/// that the surface crosses.
///
/// Throws InputError that names the file for what cannot be read; for a grid that is missing, of
/// another type, empty, under a transform that is not linear, neither level set nor fog where no
/// isovalue is given, holds what is not a number, or has no surface; and for lengths out of range.
///
/// OpenVDB trusts what a file says: a damaged one may crash it, or take all memory. Read files of
/// unknown origin in a process of their own first, as the program does.
std::vector<PointSource> read_vdb_sources(const std::filesystem::path& path,
                                          const VdbSurface& surface);

}  // namespace controlspace
