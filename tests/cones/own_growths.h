// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "controlspace/sources/point_source.h"
#include "metric/draw.h"

/// Gives most sources a gradation ratio of their own; some of the coarser ones do not grow at all.
inline std::vector<controlspace::PointSource> with_own_growths(
    std::vector<controlspace::PointSource> sources, controlspace::Draw& draw) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (i % 4 == 0) continue;
        const bool is_coarse = controlspace::mean_length(sources[i].metric) > 0.4;
        sources[i].growth =
            is_coarse && i % 16 == 1 ? 1 : 1 + draw.uniform(0.1, i % 2 == 0 ? 1.5 : 0.3);
    }
    return sources;
}
