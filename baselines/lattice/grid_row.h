// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "baselines/lattice/voxels.h"
#include "controlspace/space/catalogue.h"

namespace controlspace {

/// The row of a grid that `make` makes with one way of interpolation, in each precision.
template <auto make, Interpolation interpolation>
CatalogueEntry grid_row(std::string id, std::string description) {
    CatalogueEntry row;
    row.id = std::move(id);
    row.description = std::move(description);
    row.order = interpolation == Interpolation::nearest ? 0 : 1;
    row.capabilities = {MetricNodes(), CompactForm(), VoxelSize()};
    if (interpolation == Interpolation::trilinear) row.capabilities.push_back(FittedValues());
    row.construct = [](const SpaceOptions& options) { return make(options, interpolation); };
    return row;
}

}  // namespace controlspace
