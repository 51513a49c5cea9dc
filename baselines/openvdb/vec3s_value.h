// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <openvdb/Types.h>

#include <limits>

#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"
#include "refuse.h"

namespace controlspace {

// A metric in two vectors of floats, (xx, yy, zz) and (xy, xz, yz): what other programs can read.

inline openvdb::Vec3s diagonal(const Metric& m) {
    return {static_cast<float>(m.xx), static_cast<float>(m.yy), static_cast<float>(m.zz)};
}
inline openvdb::Vec3s off_diagonal(const Metric& m) {
    return {static_cast<float>(m.xy), static_cast<float>(m.xz), static_cast<float>(m.yz)};
}
/// From those vectors, of OpenVDB or NanoVDB.
inline Metric metric_of(const auto& diagonal, const auto& off_diagonal) {
    return {diagonal[0],     diagonal[1],     diagonal[2],
            off_diagonal[0], off_diagonal[1], off_diagonal[2]};
}

/// What floats keep of a metric. Throws InputError where they cannot hold it.
inline Metric in_floats(const Metric& m) {
    // A function of its own: GCC 12 takes what is rounded and widened at once for unrounded.
    const auto rounded = [](const Metric& full) __attribute__((noinline)) {
        return StoredMetric<float>(full);
    };
    const StoredMetric<float> kept = rounded(m);
    constexpr float least = std::numeric_limits<float>::min();
    constexpr float most = std::numeric_limits<float>::max();
    const auto fits = [&](float entry) { return entry >= least && entry <= most; };
    if (!fits(kept.xx) || !fits(kept.yy) || !fits(kept.zz) || !is_positive_definite(kept)) {
        refuse("floats cannot hold the metric {} (xx yy zz xy xz yz): use a grid of doubles",
               to_string(m));
    }
    return kept;
}

}  // namespace controlspace
