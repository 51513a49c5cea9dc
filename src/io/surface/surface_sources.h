#pragma once

#include <filesystem>

#include "controlspace/io/read_surface_sources.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {

/// Sources on a surface, as read_surface_sources makes them; errors name `file`.
SurfaceSources surface_sources(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                               const std::filesystem::path& file);

}  // namespace controlspace
