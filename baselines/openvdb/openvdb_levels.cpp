#include "baselines/openvdb/level_grids.h"

namespace controlspace {

std::unique_ptr<ControlSpaceBuilder> make_openvdb_levels(const SpaceOptions& options,
                                                         Interpolation interpolation) {
    if (interpolation == Interpolation::trilinear) return make_trilinear_levels(options);
    return std::make_unique<SharedBuilder<LevelGrids<LevelMetrics<1>>>>(options);
}

}  // namespace controlspace
