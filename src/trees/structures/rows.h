// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/space/catalogue.h"

namespace controlspace {

// One function a file.
CatalogueEntry kd_leaves();
CatalogueEntry kd_quadratic();
CatalogueEntry kd_vertices();
CatalogueEntry octree_leaves();
CatalogueEntry balanced_octree_leaves();
CatalogueEntry octree_quadratic();
CatalogueEntry octree_vertices();
CatalogueEntry kd_sources();
CatalogueEntry octree_sources();

}  // namespace controlspace
