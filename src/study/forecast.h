#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controlspace/study/run.h"

namespace controlspace {

/// What a case may cost.
struct Forecast {
    double seconds = 0;  ///< the reference's probes included, at the first case that needs them
    double bytes = 0;    ///< of the structure
};

/// Forecasts for all cases of a study, from small trials: trees and grids in levels with some
/// thousand neighbouring sources, whose cost is taken to grow in proportion; grids of one voxel
/// size with fewer voxels. Right within a factor of two or three, as a rule. None for cases whose
/// cost only running them tells: adaptation to a target, and a search for voxels; or that fail.
/// Takes some ten milliseconds a case.
std::vector<std::optional<Forecast>> forecast(const PreparedStudy& prepared);

/// The cases, their forecasts and the sum, as a table.
std::string forecast_text(const PreparedStudy& prepared,
                          const std::vector<std::optional<Forecast>>& forecasts);

}  // namespace controlspace
