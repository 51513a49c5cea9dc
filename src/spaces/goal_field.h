#pragma once

#include <memory>
#include <span>

#include "cones/cone_field.h"
#include "geometry/box.h"
#include "metric/metric_field.h"
#include "spaces/adaptation.h"

namespace controlspace {

class ControlSpace;

/// The field of a goal, whose sources must outlive it, as exact as the target needs: cones of
/// tensors that would make a difference of some hundredth of it are passed over.
class GoalField final : public MetricField {
public:
    /// Throws InputError for sources outside of `domain` or with bad metrics, a ratio below 1, a
    /// target that is not positive.
    GoalField(const AdaptationGoal& goal, const Box& domain);

    void evaluate(std::span<const Point> x, std::span<Metric> out) const override;
    /// The same on the calling thread, for few places.
    void evaluate_here(std::span<const Point> x, std::span<Metric> out) const;

    /// Largest δ between `space` and the field at places all over the domain and near to sources.
    double largest_departure(const ControlSpace& space) const;

    const ConeField& cones() const { return cones_; }
    double target() const { return target_; }

private:
    double target_;
    std::span<const PointSource> sources_;
    std::shared_ptr<const MetricField> continuous_;
    ConeField cones_;
};

}  // namespace controlspace
