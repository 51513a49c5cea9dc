#include "baselines/openvdb/level_grids.h"

namespace controlspace {

std::unique_ptr<ControlSpaceBuilder> make_trilinear_levels(const SpaceOptions& options) {
    return std::make_unique<SharedBuilder<LevelGrids<LevelMetrics<8>>>>(options);
}

}  // namespace controlspace
