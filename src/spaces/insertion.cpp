#include "spaces/insertion.h"

#include "metric/intersection.h"
#include "metric/nonconformity.h"

namespace controlspace {

bool calls_for_change(const Metric& asked, const Metric& held, double tolerance) {
    if (nonconformity(asked, held) < tolerance) return false;
    const Metric limited = intersection(held, asked);
    return limited != held && nonconformity(held, limited) >= tolerance;
}

}  // namespace controlspace
