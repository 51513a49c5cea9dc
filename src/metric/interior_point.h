// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "controlspace/metric/metric.h"
#include "metric/constraint_lanes.h"

namespace controlspace {

/// The largest metric within a few others: maximises log det Y under Y <= M_k^2, by a primal-dual
/// interior-point method.
///
/// Everything is kept as seen from the factor H of the present Y = H H^T, where Y is the identity
/// and constraint k is P_k = (M_k^-1 H)^T (M_k^-1 H) <= I. So all numbers are at most 1 but for
/// inverses of slacks, and no accuracy is lost to anisotropy.
class InteriorPoint {
public:
    /// Most metrics.
    static constexpr std::size_t room = 16;

    /// Between 1 and `room` positive definite metrics. Starts from a regular `near` such that
    /// near near^T is close to the answer, or from nothing: from the parallel sum
    /// (sum of M_k^-2)^-1, which is within all M_k^2, and at most their number times too small.
    explicit InteriorPoint(std::span<const Metric> metrics, const Eigen::Matrix3d* near = nullptr);

    /// Reduces the duality gap to `tolerance`, at least 1e-12, or as far as rounding allows.
    void solve(double tolerance);

    /// H; H H^T lies strictly within all M_k^2.
    const Eigen::Matrix3d& factor() const { return factor_; }
    /// By how much log det Y can be larger at most.
    double gap() const { return gap_; }
    int steps() const { return steps_; }
    /// Multiplier of constraint k that proves the gap, L, as seen from H: itself it is H^-T L H^-1.
    Metric multiplier(std::size_t k) const {
        return certificate_scale_ *
               certificate_[k / constraint_lanes][static_cast<Eigen::Index>(k % constraint_lanes)];
    }

private:
    static constexpr std::size_t most_groups = room / constraint_lanes;
    using Groups = std::array<ConstraintLanes, most_groups>;

    std::span<const ConstraintLanes> used(const Groups& groups) const {
        return {groups.data(), groups_};
    }
    void set_constraints(std::span<const Metric> metrics, const Eigen::Matrix3d* near);
    double greatest_eigenvalue() const;
    void scale(double factor);
    void set_multipliers();
    void measure();
    double advance(double centring);

    std::size_t size_;
    std::size_t groups_;
    Eigen::Matrix3d factor_;
    Groups constraints_;  ///< P_k, or 0 where there is none
    Groups multipliers_;  ///< L_k
    Groups certificate_;  ///< P_k L_k P_k
    double certificate_scale_ = 1;
    double mu_ = 0;
    double gap_ = 0;
    int steps_ = 0;
};

/// Caratheodory: of any number of symmetric tensors, six at most have combinations of the same sum
/// with weights >= 0. Returns them as bits. At most `InteriorPoint::room` tensors.
std::uint32_t needed_multipliers(std::span<const Metric> tensors);

}  // namespace controlspace
