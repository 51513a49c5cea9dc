#pragma once

#include <functional>
#include <memory>
#include <span>

#include "cones/cone_field.h"
#include "controlspace/geometry/box.h"
#include "controlspace/space/adaptation.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// The field of a goal, whose sources must outlive it, as exact as the target needs: cones of
/// tensors that would make a difference of some hundredth of it are passed over.
class GoalField final : public ControlSpace {
public:
    /// Throws InputError for sources outside of `domain` or with bad metrics, a ratio below 1, a
    /// target that is not positive.
    GoalField(const AdaptationGoal& goal, const Box& domain);

    void sample(std::span<const Point> x, std::span<Metric> out) const override;
    /// The same for places near to each other; `memory` should be kept from
    /// one call to the next.
    void evaluate_here(std::span<const Point> x, std::span<Metric> out,
                       ConeField::Memory& memory) const;
    /// The same where `nearby` has all cones that matter at the places.
    void evaluate_here(std::span<const Point> x, std::span<Metric> out,
                       const NearbyCones& nearby) const;

    /// The same, or longer by a factor less than the one returned, where that is quicker.
    double evaluate_roughly(std::span<const Point> x, std::span<Metric> out,
                            ConeField::Memory& memory) const;

    /// Whether its bounds in a box can be told: all is isotropic, and no source continuous.
    bool has_ranges() const { return continuous_ == nullptr && cones_.is_isotropic(); }
    /// The bounds, as `IsotropicCones::range_in` has them.
    IsotropicCones::Range range_in(const Box& box, ConeField::Memory& memory) const {
        return cones_.range_in(box, memory);
    }

    /// Answers metrics at places.
    using Sample = std::function<void(std::span<const Point>, std::span<Metric>)>;
    /// Largest δ between what `sample` answers and the field, at places all over the domain and
    /// near to sources.
    double largest_departure(const Box& domain, const Sample& sample) const;

    const ConeField& cones() const { return cones_; }
    const Metric& largest() const { return largest_; }
    double target() const { return target_; }
    double ratio() const { return ratio_; }

private:
    void add_continuous(std::span<const Point> x, std::span<Metric> out) const;

    double target_;
    double ratio_;
    std::span<const PointSource> sources_;
    std::shared_ptr<const ControlSpace> continuous_;
    Metric largest_;
    ConeField cones_;
};

}  // namespace controlspace
