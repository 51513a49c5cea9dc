#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cones/cone_field.h"
#include "geometry/box.h"
#include "metric/metric_field.h"
#include "sources/point_source.h"

namespace controlspace {

/// The field that a structure is to follow, and how closely.
///
/// The field is exact: the intersection of M_max, the cones of `sources` (paper §5.2) and, taken as
/// it stands, `continuous`.
struct AdaptationGoal {
    std::span<const PointSource> sources;
    std::shared_ptr<const MetricField> continuous;  ///< or none
    double ratio = 1.25;                            ///< g_r of the sources' cones
    double target = 0.1;                            ///< largest δ to the field; 0 is out of reach
};

struct AdaptationReport {
    /// Largest δ to the field wherever the finished structure was looked at, at sources and at
    /// places that it was not fitted to. Places are samples: a peak between them may be higher.
    double reached = 0;
    bool met = false;       ///< reached <= target
    std::string shortfall;  ///< why it was not met, and what would help; empty where it was
};

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
