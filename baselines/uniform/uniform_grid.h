#pragma once

#include <memory>
#include <vector>

#include "baselines/lattice/voxels.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Uniform Cartesian grid over the domain, its metrics in one flat array, x fastest: what a user
/// writes who wants no tree. Voxels as `choose_voxels` has them; throws InputError as it does.
std::unique_ptr<ControlSpaceBuilder> make_uniform_grid(const SpaceOptions& options,
                                                Interpolation interpolation);

/// It with either interpolation.
std::vector<CatalogueEntry> uniform_rows();

}  // namespace controlspace
