// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "controlspace/space/catalogue.h"
#include "controlspace/study/case.h"

namespace controlspace {

/// Measures of a grid under one setting.
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

/// The voxels with which a grid reaches `equal_delta` of the case in the least memory, or those
/// that use `equal_memory` up, to 3 %. Voxels are halved, from a quarter of `longest_edge` on,
/// until the goal is passed; then the last interval is bisected. A grid with Pruning is also tried
/// with half of `equal_delta` as prune_delta, where none is set.
///
/// `attempt` makes and measures a grid. An InputError from it (too much memory) ends the search at
/// the voxels before, and so do two halvings that change less than 5 %. If the first attempt
/// throws, so does this.
EqualSetting find_equal_setting(const Case& c, const CatalogueEntry& entry, double longest_edge,
                                const std::function<Trial(const Case&)>& attempt);

}  // namespace controlspace
