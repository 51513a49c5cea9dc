// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "controlspace/input_errors.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/space_options.h"

namespace controlspace {

/// Throws GrowthStopped beyond the limit's deadline.
inline void require_in_time(const GrowthLimit& limit) {
    if (limit.is_late()) throw GrowthStopped(GrowthStop::time, 0, "no time was left");
}

/// Answers as another space does, until a deadline: then it throws GrowthStopped, at most some
/// hundred places later.
class UntilLate final : public ControlSpace {
public:
    UntilLate(const ControlSpace& space, const GrowthLimit& limit) : space_(space), limit_(limit) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        constexpr std::size_t together = 256;  // a quarter of a second where tensors take long
        while (!x.empty()) {
            require_in_time(limit_);
            const std::size_t n = std::min(together, x.size());
            space_.sample(x.first(n), out.first(n));
            x = x.subspan(n);
            out = out.subspan(n);
        }
    }
    Box domain() const override { return space_.domain(); }

private:
    const ControlSpace& space_;
    GrowthLimit limit_;
};

}  // namespace controlspace
