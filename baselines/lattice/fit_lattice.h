// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "baselines/lattice/lattice_data.h"
#include "space/goal_field.h"

namespace controlspace {

/// A lattice whose nodes were set to follow a field.
struct FittedLattice {
    Voxels voxels;
    std::vector<Metric> nodes;
    double reached =
        0;  ///< a δ that is kept everywhere if `is_bound`, else the largest that was found
    bool is_bound = false;  ///< shown by bounds
    bool met = false;
    bool is_stopped = false;  ///< the search, by its limit
};

/// Fits the nodes of lattices over a domain to a field, with what a grid of `kind` makes of them:
/// cells of lengths by the bounds of trees, which hold everywhere (K_oL's where they are constant,
/// K_oV's where they are trilinear); of tensors and continuous fields by probes: all over the
/// domain, at sources and beside them.
class LatticeFit {
public:
    /// Where `stop` (GrowthLimit) is set, this and all below throw GrowthStopped.
    LatticeFit(const GoalField& field, const AdaptationGoal& goal, const Box& domain,
               const GridKind& kind, int* stop);

    /// Lattices of tensors and continuous fields are tried up to so many cells: each node takes a
    /// search of its own.
    static constexpr double most_cells_by_probes = 1 << 21;

    /// With these voxels; values of the goal's kind.
    FittedLattice at(const Voxels& voxels) const;
    /// With about the largest that keep the field's target, found by halving, then bisection, until
    /// the limit's deadline; `voxels_of(edge)` are those with such edges, none where they would
    /// outgrow the memory, but for one cell along the longest edge. Where none keep it, with the
    /// finest that was tried to its end. Fitted values take at most as many cells as the field's
    /// own.
    FittedLattice coarsest(const std::function<std::optional<Voxels>(double edge)>& voxels_of,
                           const GrowthLimit& limit) const;

private:
    template <class Stencil>
    bool may_keep_probes(const Stencil& stencil, const GrowthLimit& limit) const;
    /// A `trial` ends, not met, as soon as it is known to miss the target.
    template <Interpolation interpolation>
    FittedLattice fitted(const Voxels& voxels, NodeValues values, const GrowthLimit* trial) const;
    FittedLattice fitted(const Voxels& voxels, NodeValues values, const GrowthLimit* trial) const;

    const GoalField& field_;
    Box domain_;
    GridKind kind_;
    NodeValues values_;
    GrowthLimit stop_;             ///< no deadline
    std::vector<Point> suspects_;  ///< where lattices that are too coarse mostly show it
    std::vector<Point> probes_;    ///< where there are no bounds, and the field there
    std::vector<Metric> at_probes_;
};

}  // namespace controlspace
