// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/input_errors.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// Throws GrowthStopped beyond the limit's deadline.
inline void require_in_time(const GrowthLimit& limit) {
    if (limit.is_late()) throw GrowthStopped(GrowthStop::time, 0, "no time was left");
}

/// Answers batches as another space does, until a deadline: then they throw GrowthStopped.
class UntilLate final : public ControlSpace {
public:
    UntilLate(const ControlSpace& space, const GrowthLimit& limit) : space_(space), limit_(limit) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        require_in_time(limit_);
        space_.sample(x, out);
    }
    Box domain() const override { return space_.domain(); }

private:
    const ControlSpace& space_;
    GrowthLimit limit_;
};

}  // namespace controlspace
