#pragma once

#include <cstddef>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// What metrics ask for, at a glance.
struct LengthSummary {
    std::size_t count = 0;
    std::size_t isotropic = 0;  ///< how many ask for the same length in every direction
    double finest = 0;          ///< smallest length in any direction
    double coarsest = 0;        ///< largest length in any direction
    double mean = 0;            ///< mean over the metrics of their mean length
    double anisotropy = 1;      ///< largest ratio of a metric's largest length to its smallest
};

LengthSummary summarise_lengths(std::span<const Metric> metrics);

/// What sources ask for, and where.
struct SourceSummary : LengthSummary {
    std::size_t contradictory = 0;  ///< how many lie where another one asks for something else
    Box extent;                     ///< the smallest box around them
    /// Largest gradation ratio, under the cone law, from a source to one of the six nearest that
    /// are not at its very place: a field graded with less takes something off the sources.
    double gradation = 1;
};

/// Throws InputError for no sources.
SourceSummary summarise(std::span<const PointSource> sources);

}  // namespace controlspace
