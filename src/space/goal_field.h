// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

class ConeField;
class GoalCache;

/// The field of a goal, whose sources must outlive it, as exact as the target needs: order-free, to
/// a tenth of the target; in turn, cones of tensors that would change it by some hundredth of the
/// target are left out.
class GoalField final : public ControlSpace {
public:
    /// Answers of tensors, of some 230 bytes each, that are kept from leaf to leaf at most.
    static constexpr std::size_t many_answers = 500'000;

    /// Whether a tenth of the target's ln k may be spent on leaving out isotropic sources that lie
    /// nearly on others' cones, where these are many. The field is longer by that at most, and
    /// `target` is what is left: whoever keeps it keeps that of the goal.
    enum class Thinning { none, allowed };

    /// Throws InputError for sources outside of `domain` or with bad metrics, a ratio below 1, a
    /// target that is not positive.
    GoalField(const AdaptationGoal& goal, const Box& domain,
              std::size_t most_answers = many_answers, Thinning thinning = Thinning::none);
    ~GoalField() override;

    void sample(std::span<const Point> x, std::span<Metric> out) const override;
    /// The continuous field at `x`; empty if there is none.
    std::vector<Metric> continuous_at(std::span<const Point> x) const;

    /// Whether the field has bounds in every box: all is isotropic, and no source continuous.
    bool has_ranges() const;
    /// Of isotropic sources: indices of those that are not covered by others.
    std::span<const std::uint32_t> kept() const;

    /// Answers metrics at places.
    using Sample = std::function<void(std::span<const Point>, std::span<Metric>)>;
    /// Places all over the domain and near to sources, 100 000 of each.
    std::vector<Point> probes(const Box& domain) const;
    /// Largest δ (`directional_nonconformity`) between what `sample` answers and the field, at
    /// these probes. Throws GrowthStopped beyond the limit's deadline.
    double largest_departure(const Box& domain, const Sample& sample,
                             const GrowthLimit& limit = {}) const;

    /// What is kept from leaf to leaf.
    GoalCache& cache() const { return *cache_; }
    /// Not while others use the cache.
    void forget_if_full() const;

    const ConeField& cones() const { return *cones_; }
    /// Whether tensors are intersected without an order.
    bool is_order_free() const;
    /// Whether it may, where tensors are intersected in turn.
    bool jumps() const;
    /// Whether there are sources, and so few that the field can be evaluated closely everywhere.
    bool has_few_sources() const { return has_sources_up_to(few_sources); }
    bool has_sources_up_to(std::size_t most) const {
        return !sources_.empty() && sources_.size() <= most;
    }
    /// Relative shortening of lengths that is left out.
    double negligible() const;
    const Metric& largest() const { return largest_; }
    double target() const { return target_; }
    /// δ to the field of all sources, where that to this one is `delta`.
    double departure_from_all(double delta) const;
    /// Of sources that have none of their own.
    double ratio() const { return ratio_; }
    /// The largest of all sources' and that one.
    double largest_ratio() const { return largest_ratio_; }

    static constexpr std::size_t few_sources = 512;

private:
    double whole_target_;
    double target_;  ///< less what thinning takes
    double ratio_;
    double largest_ratio_;
    std::span<const PointSource> sources_;
    std::shared_ptr<const ControlSpace> continuous_;
    Metric largest_;
    std::unique_ptr<const ConeField> cones_;
    std::unique_ptr<GoalCache> cache_;
};

}  // namespace controlspace
