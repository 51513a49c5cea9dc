// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controlspace/input_errors.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// What a structure that interpolates between its nodes gives them.
enum class NodeValues : std::uint8_t {
    field,  ///< the field's own values
    /// Lengths that are fitted to the field around each node, so that fewer nodes keep the same
    /// target. Between nodes they may grow faster than the field does.
    fitted
};
/// The field that a structure is to follow, and how closely.
///
/// The field is exact: the intersection of M_max, the cones of `sources` (paper §5.2) and, taken as
/// it stands, `continuous`.
struct AdaptationGoal {
    std::span<const PointSource> sources;
    std::shared_ptr<const ControlSpace> continuous;  ///< or none
    double ratio = 1.25;                             ///< g_r of the sources' cones
    /// Largest δ to the field (`directional_nonconformity`); 0 is out of reach. Of thousands of
    /// isotropic sources that lie nearly on each other's cones, as the vertices of a graded mesh
    /// do, trees leave out those within a tenth of it (of ln k, k the factor between lengths), if
    /// most are, and keep the rest of it: together, it is kept of all sources.
    double target = 0.1;
    IntersectionRule intersection = IntersectionRule::order_free;
    double h_max = largest_magnitude;  ///< as of SpaceOptions: bounds M_max
    /// What will be built (BuildOptions::precision): the target is kept by the numbers that a query
    /// reads back, not only by those before they are rounded. Refused, by InputError, are codes
    /// whose rounding takes more than a third of what the target allows, as the ratio of lengths.
    Precision precision = Precision::doubles;
    /// Fitted, by structures that can alone (the capability FittedValues), and of isotropic sources
    /// without a continuous field; others refuse it, by InputError. What takes more than 2^18 cells
    /// keeps the field's own.
    NodeValues values = NodeValues::field;
    /// Further places where trees are compared with the field, such as the middle of what is small
    /// in `continuous`; they may be outside the domain.
    std::span<const Point> places = {};
    /// Trees with this many leaves are cut no further. What is farthest from the field is cut
    /// first.
    std::size_t max_leaves = std::numeric_limits<std::size_t>::max();
};

struct AdaptationReport {
    /// For trees, where all is isotropic and no source continuous, but not for K_Li and K_oLi: a δ
    /// that is shown, by bounds, to be kept everywhere; above the target, one that was found, or
    /// infinity where neither could be shown in a leaf that was not to be cut. Otherwise the
    /// largest sampled δ; below 3/4 of the target, a bound of it. Samples are taken at sources and
    /// next to them in the leaves beside them, at places that the structure was not fitted to, and
    /// by hill climbs from the worst of these, and, of tensors without an order, along edges of
    /// trilinear leaves where cones are steep; a peak between them may be higher. With up to 512
    /// sources, leaves are cut from 0.96 of the target on, and trilinear ones are compared with the
    /// cone of each source, also around their tips; others are with up to 64. With more tensors,
    /// leaves are cut from 0.99 of it on, and most places are compared with sources close to those
    /// that matter nearby; those that may be above it, and the worst so far, with all, to a
    /// hundredth of the target.
    double reached = 0;
    bool is_bound = false;  ///< `reached` is kept everywhere; otherwise it was sampled
    bool met = false;       ///< reached <= target
    std::string shortfall;  ///< why it was not met, and what would help; empty where it was
    GrowthStop stop = GrowthStop::none;  ///< the limit at which it stopped, where it was not met
};

}  // namespace controlspace
