#pragma once

#include "controlspace/metric/metric_field.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// What a control space answers, as a field, in the thread that asks. The space must outlive it.
class SpaceAsField final : public MetricField {
public:
    explicit SpaceAsField(const ControlSpace& space) : space_(space) {}

    void evaluate(std::span<const Point> x, std::span<Metric> out) const override {
        space_.sample(x, out);
    }

private:
    const ControlSpace& space_;
};

}  // namespace controlspace
