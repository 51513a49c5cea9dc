#pragma once

#include <functional>
#include <string>

#include "controlspace/space/catalogue.h"
#include "controlspace/study/case.h"

namespace controlspace {

/// How a grid comes out under one setting.
struct Trial {
    double delta = 0;  ///< largest δ_R
    double bytes = 0;
};

/// The setting that was found for a grid.
struct EqualSetting {
    Case setting;
    Trial trial;
    std::string shortfall = {};  ///< why the goal was missed, by the setting that came nearest
};

/// The voxels with which a grid comes to `equal_delta` of the case in the least memory, or those
/// that use up `equal_memory`, to 3 %: `voxel`; in levels `voxel_factor` goes with it, so that the
/// finest voxels are those where `finest_length` is asked for. Voxels are halved, from a quarter of
/// `longest_edge` on, until the goal is passed; what lies between is bisected. A grid that can
/// prune, and is not told how, is tried with half of `equal_delta` for its tolerance too.
///
/// `attempt` makes and measures a grid; it may throw InputError for one that takes too much memory:
/// the voxels that come closest to it end the search, as do voxels that are halved twice for less
/// than 5 %. If the very first attempt throws, so does this.
EqualSetting find_equal_setting(const Case& c, const CatalogueEntry& entry, double longest_edge,
                                double finest_length,
                                const std::function<Trial(const Case&)>& attempt);

}  // namespace controlspace
