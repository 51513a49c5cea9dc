#pragma once

#include <filesystem>
#include <vector>

#include "sources/point_source.h"
#include "study/vdb_choice.h"

namespace controlspace {

/// Isotropic sources on the surface of a level set or a fog (a grid of floats): one in each voxel
/// that the surface crosses.
///
/// Throws InputError that names the file for what cannot be read; for a grid that is missing, of
/// another type, empty, under a transform that is not linear, neither level set nor fog where no
/// isovalue is given, holds what is not a number, or has no surface; and for lengths out of range.
std::vector<PointSource> read_vdb_sources(const std::filesystem::path& path,
                                          const VdbSurface& surface);

}  // namespace controlspace
