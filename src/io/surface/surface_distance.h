// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/fields/primitives.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {

/// The exact distance from the triangles of `mesh`, on both sides of the surface.
DistanceField surface_distance(const SurfaceMesh& mesh);

}  // namespace controlspace
