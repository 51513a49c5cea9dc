// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// What one source did to a control space (paper §3.1).
enum class Insertion {
    already_met,  ///< the field is near the source's metric, or smaller: nothing changed
    inserted,     ///< the field was made smaller at the source
};

struct InsertionReport {
    std::uint64_t sources = 0;
    std::uint64_t inserted = 0;

    InsertionReport& operator+=(const InsertionReport& other) {
        sources += other.sources;
        inserted += other.inserted;
        return *this;
    }
};

/// Steps 2 and 3 of insertion: whether a source of metric `requested`, at a place where the
/// structure has `held`, has to change it: δ(requested, held) >= tolerance, and intersecting
/// changes `held` by at least the tolerance as well.
bool calls_for_change(const Metric& requested, const Metric& held, double tolerance);

/// How many times longer than an isotropic source a metric may be, in any direction, and
/// calls_for_change still be false; less by a millionth, in which rounding has room.
double length_let_pass(double tolerance);

}  // namespace controlspace
