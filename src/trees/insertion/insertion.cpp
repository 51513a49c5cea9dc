// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/insertion.h"

#include "controlspace/metric/intersection.h"
#include "controlspace/metric/nonconformity.h"

namespace controlspace {

bool calls_for_change(const Metric& requested, const Metric& held, double tolerance) {
    // At once where an intersection would leave `held` as it is.
    if (is_axis_aligned(requested) && is_axis_aligned(held) && held.xx <= requested.xx &&
        held.yy <= requested.yy && held.zz <= requested.zz) {
        return false;
    }
    if (nonconformity(requested, held) < tolerance) return false;
    const Metric limited = intersection(held, requested);
    return limited != held && nonconformity(held, limited) >= tolerance;
}

// The intersection divides each principal length by k at most, so δ is √3 (k + 1/k - 2) at most.
double length_let_pass(double tolerance) { return largest_factor_within(tolerance) * (1 - 1e-6); }

}  // namespace controlspace
