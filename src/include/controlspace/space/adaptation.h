#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controlspace/metric/intersection.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// The field that a structure is to follow, and how closely.
///
/// The field is exact: the intersection of M_max, the cones of `sources` (paper §5.2) and, taken as
/// it stands, `continuous`.
struct AdaptationGoal {
    std::span<const PointSource> sources;
    std::shared_ptr<const ControlSpace> continuous;  ///< or none
    double ratio = 1.25;                             ///< g_r of the sources' cones
    double target = 0.1;                             ///< largest δ to the field; 0 is out of reach
    IntersectionRule intersection = IntersectionRule::order_free;
};

struct AdaptationReport {
    /// Largest sampled δ to the field: at sources and at places that the structure was not fitted
    /// to; below 3/4 of the target, a bound of it. Places are samples: a peak between them may be
    /// higher. Not so of trees whose leaves are constant or keep sources (K_L, K_oL, K_oLB, K_LA,
    /// K_oLA) where all is isotropic and no source continuous: there it is a bound that holds
    /// everywhere.
    double reached = 0;
    bool met = false;       ///< reached <= target
    std::string shortfall;  ///< why it was not met, and what would help; empty where it was
};

}  // namespace controlspace
