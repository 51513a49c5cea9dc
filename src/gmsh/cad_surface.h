// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "controlspace/geometry/box.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {

/// Triangles of the surface of a CAD file, which turn by 10 degrees from one to the next where it
/// is curved, and the exact curvatures of its faces at their corners: at poles and apexes, which
/// have none, those a little beside; unknown where a face does not say where its node is. Runs in a
/// GmshSession. Throws InputError that names the file for what Gmsh cannot read, and for one
/// without surfaces.
SurfaceMesh read_cad_surface(const std::filesystem::path& path);

/// The box around the shapes of a CAD file, in millimetres. Throws as read_cad_surface does.
Box cad_box(const std::filesystem::path& path);

}  // namespace controlspace
