// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "controlspace/io/read_surface_sources.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {

/// Sources on a surface, as read_surface_sources makes them; errors name `file`.
SurfaceSources surface_sources(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                               const std::filesystem::path& file);

/// What a wall or gap asks for at a place of a surface.
struct WallRequest {
    Point place;
    Vector normal;  ///< of the surface there
    double length;  ///< along it: the thickness / elements_across, within the bounds
};

/// Requests at the places among `rays` random ones, uniform on the surface, whose ray along the
/// normal meets a wall or gap: a check of sources that does not depend on where they are, nor on
/// the normals that smooth patches give to flat triangles. Errors name `file`.
std::vector<WallRequest> wall_requests(const SurfaceMesh& mesh, const CurvatureSizes& sizes,
                                       std::size_t rays, std::uint64_t seed,
                                       const std::filesystem::path& file);

}  // namespace controlspace
