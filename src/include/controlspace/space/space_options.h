// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <limits>
#include <optional>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/metric/metric.h"
#include "controlspace/space/split_rule.h"

namespace controlspace {

/// The deepest levels that trees may be given, the root being 0: past them a double has no number
/// left between the faces of any box.
inline constexpr int deepest_kd_level = 200;
inline constexpr int deepest_octree_level = 60;

/// The deepest levels of leaves that are cut for sources, unless told otherwise (paper §5.1).
inline constexpr int usual_kd_level = 42;
inline constexpr int usual_octree_level = 14;

/// How trees with quadratic leaves (K_Li, K_oLi) interpolate.
enum class QuadraticForm {
    corrected,  ///< paper §3.1 with its coordinates put right, kept within the leaf's cone
    /// As the published program did, for comparison: the trilinear part is evaluated at t in [0,1]
    /// in place of 2t - 1, one corner takes the wrong face, and nothing bounds the result.
    published,
};

/// When trees stop growing, finished or not. Adaptation then reports how far it came
/// (AdaptationReport::stop); insertion, and gradation that cuts leaves, throw GrowthStopped.
struct GrowthLimit {
    using Clock = std::chrono::steady_clock;
    Clock::time_point deadline = Clock::time_point::max();
    std::size_t bytes = std::numeric_limits<std::size_t>::max();  ///< of the tree, gradation aside
    /// Unless null, a number that another thread or a signal handler sets to 1, which ends growth
    /// as the deadline does. It must outlive what is made with these options.
    int* stop = nullptr;

    bool is_late() const {
        if (stop != nullptr && std::atomic_ref(*stop).load(std::memory_order_relaxed) != 0) {
            return true;
        }
        return deadline != Clock::time_point::max() && Clock::now() >= deadline;
    }
};

/// What a structure is made with.
struct SpaceOptions {
    Box domain;
    SplitRule split = SplitRule::middle;  ///< kd-trees only
    double l_min = 1;        ///< longest edge of a source's leaf, in the source's metric (τ)
    double tolerance = 0.2;  ///< ε_δ of insertion
    /// Deepest levels of kd-trees and octrees, the root being 0. None: the usual ones where leaves
    /// are cut for sources, the deepest where they follow a field.
    std::optional<int> kd_depth = {};
    std::optional<int> octree_depth = {};
    double finest_length = 0;  ///< smallest length any source requests; grids size voxels by it
    double voxel = 0;          ///< longest edge of a grid's voxels; 0: l_min * finest_length
    double h_max = largest_magnitude;  ///< bounds M_max; K_Li and K_oLi overshoot it a little
    double prune_delta = 0;  ///< δ up to which voxels of a field that is set join; 0: none do
    /// g_r of the gradation to come, for structures that keep sources, and for those with quadratic
    /// leaves, whose interpolation it bounds until they are graded.
    double ratio = 1.25;
    QuadraticForm quadratic_form = QuadraticForm::corrected;
    /// Of cones, in structures that keep sources, and in gradation by the sources.
    IntersectionRule intersection = IntersectionRule::order_free;
    /// Sources may come after gradation. The builder, and what it builds, then keep all that they
    /// were given, and gradation builds again: the field is that of all sources at once, to the
    /// bit. A builder that was adapted is adapted to all sources, to the same goal, with the ratio
    /// of the gradation; a target that is missed then is not reported. Metrics that were assigned
    /// stay what later sources are inserted into. Until then the field is the old one, lowered at
    /// the new sources. Costs the memory of the sources, or of the assigned field, and while it is
    /// built again that of the old field. A continuous field is not saved: what was adapted to one
    /// goes on from its metrics once it is loaded.
    ///
    /// Without it, later sources are compared with the graded field, so that they cut fewer leaves,
    /// and gradation from node to node starts from that. Trees that keep sources search the
    /// governing sources of all leaves again, which gives a field close to that of all at once.
    /// `direct` always gives the field of all sources.
    bool takes_later_sources = false;
    /// Trees with a metric a vertex (K_V, K_oV) and the balanced one (K_oLB), as published: sources
    /// are inserted one after the other; a new vertex takes what is interpolated there at that
    /// moment, and leaves are balanced after each source. Wanted for gradation from node to node
    /// that is to give the paper's tables.
    /// Otherwise leaves request what their sources do, as in K_L and K_oL, on all of TBB's threads;
    /// a vertex requests the intersection of the leaves around it, and leaves are balanced at the
    /// end.
    bool vertices_in_turn = false;
    /// Cap on memory, gradation included: grids get coarser, trees that outgrow it throw
    /// InputError. The sources that a builder keeps to grade by them, up to 72 bytes each, and the
    /// search through them while it does, are not counted.
    std::size_t max_bytes = std::size_t{4} << 30;
    GrowthLimit growth = {};  ///< grids: the search for voxels; not saved
};

/// M_max, which a new control space holds everywhere: H I, H half of the domain's diagonal, or
/// `h_max` where that is less.
inline Metric largest_metric(const Box& domain, double h_max = largest_magnitude) {
    return Metric::isotropic(std::min(domain.half_diagonal(), h_max));
}
inline Metric largest_metric(const SpaceOptions& options) {
    return largest_metric(options.domain, options.h_max);
}

/// Depths and lengths within what the structures can hold; throws InputError that names the option.
void require_valid(const SpaceOptions& options);

}  // namespace controlspace
