// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Summary of the lengths of metrics.
struct LengthSummary {
    std::size_t count = 0;
    std::size_t isotropic = 0;  ///< number of isotropic metrics
    double finest = 0;          ///< smallest length in any direction
    double coarsest = 0;        ///< largest length in any direction
    double mean = 0;            ///< mean over the metrics of their mean length
    double anisotropy = 1;      ///< largest ratio of a metric's largest length to its smallest
};

LengthSummary summarise_lengths(std::span<const Metric> metrics);

/// Summary of sources.
struct SourceSummary : LengthSummary {
    std::size_t contradictory = 0;  ///< number of sources at the position of a different one
    Box extent;                     ///< the smallest box around them
    /// Largest gradation ratio, under the cone law, from a source to one of the six nearest at
    /// other positions: gradation with a smaller ratio shortens lengths of the sources. Of those
    /// that share a position, the one with the smallest mean length counts.
    double gradation = 1;
    std::size_t own_growths = 0;  ///< number of sources with gradation ratios of their own
    double least_growth = 0;      ///< of those
    double most_growth = 0;       ///< of those
};

/// Throws InputError for no sources.
SourceSummary summarise(std::span<const PointSource> sources);

}  // namespace controlspace
