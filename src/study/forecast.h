// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controlspace/study/run.h"

namespace controlspace {

/// Predicted cost of a case.
struct Forecast {
    double seconds = 0;  ///< the reference's probes included, at the first case that needs them
    double bytes = 0;    ///< of the structure
};

/// Forecasts for all cases of a study, extrapolated from small trials: of trees with some thousand
/// neighbouring sources (adapted to tensors, some hundred), of grids with fewer voxels. Usually
/// correct within a factor of two or three. None for cases that cannot be predicted (voxels for an
/// equal error or memory, continuous fields), and for those whose trial fails or takes over 5 s.
/// Costs some ten milliseconds a case, adapted to a small target up to some seconds.
std::vector<std::optional<Forecast>> forecast(const PreparedStudy& prepared);

/// The cases, their forecasts and the sum, as a table.
std::string forecast_text(const PreparedStudy& prepared,
                          const std::vector<std::optional<Forecast>>& forecasts);

}  // namespace controlspace
