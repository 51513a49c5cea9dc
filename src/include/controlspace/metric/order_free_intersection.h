// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Largest metric within some metrics M_k, and a certificate that it is.
struct OrderFreeIntersection {
    /// Multiplier of the constraint M^2 <= M_k^2, k = `index`. As seen from `factor` H it is the
    /// positive semidefinite tensor L; itself it is H^-T L H^-1.
    struct Multiplier {
        std::uint32_t index;
        Metric tensor;
    };
    static constexpr std::size_t most_multipliers = 16;

    /// H with H H^T = M^2, not symmetric in general. A nearby intersection starts from it.
    Eigen::Matrix3d factor;
    /// log det M^2 is at most this much below that of the largest metric (duality gap). Seen from
    /// H, that is -log det(sum L_k) + sum tr(L_k H^-1 M_k^2 H^-T) - 3. Lengths are shorter than
    /// those of the largest metric by a fraction of at most 2 sqrt(gap), nearly. It is computed up
    /// to the rounding that order_free_intersection() states.
    double gap = 0;
    /// Newton steps made.
    int steps = 0;

    std::span<const Multiplier> multipliers() const { return {multiplier.data(), count}; }
    /// M.
    Metric metric() const;

    std::array<Multiplier, most_multipliers> multiplier{};
    std::size_t count = 0;
};

/// Intersection of any number of metrics, whatever their order: the metric M within all of them
/// whose elements are the largest,
///     M^2 = argmax { log det Y : Y <= M_k^2 for all k },
/// where <= says that the difference is positive semidefinite. Its unit ball is the ellipsoid of
/// greatest volume in all unit balls (Loewner-John ellipsoid: John 1948; Boyd & Vandenberghe,
/// Convex Optimization, section 8.4). It is unique, continuous in the M_k, and covariant: a linear
/// map A of space takes M^2 to A M^2 A^T. Of two metrics it is their `intersection`, of isotropic
/// ones the smallest. One metric more never makes the determinant larger, but may make M longer
/// along some direction.
///
/// M is within every M_k, and the duality gap at most `tolerance`, 1e-10 or more, up to rounding:
/// a relative 2e-14 A (1 + A / 1e6) of lengths and of the determinant, where A is the largest
/// anisotropy of the M_k. That is 2e-12 for A = 100, 4e-8 for 1e6, 2e-6 for 1e7. A metric that is
/// within all others is the answer to the bit. The bits do not depend on the order
/// of the metrics, but on `near`, an initial guess: the regular factor of a metric that is likely
/// to be close to the answer (its matrix will do).
///
/// Allocates nothing. Throws InputError if there are no metrics, or if one is not positive
/// definite, has numbers that are not finite, lengths beyond 1e-80 to 1e80, or where tr(M) tr(M^-1)
/// / 9 exceeds 1e7 (anisotropies above 9e7, and none below 1e7): round-off then hides the shortest
/// lengths of M^2.
OrderFreeIntersection order_free_intersection(std::span<const Metric> metrics,
                                              double tolerance = 1e-6,
                                              const Eigen::Matrix3d* near = nullptr);

}  // namespace controlspace
