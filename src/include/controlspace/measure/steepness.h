// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// How fast the metrics M of a finished field grow with distance, as gradation ratios: the largest
/// over pairs of nearby places p and q. Pure numbers, 1 for a constant field.
struct Steepness {
    /// 1 + ((det M(q) / det M(p))^(1/3) - 1) / |M(p)^-1 (q - p)|. The exact field, order-free or of
    /// isotropic sources, has at most g_r.
    double det = 1;
    /// 1 + (k - 1) / |M(p)^-1 (q - p)|, where k is the largest growth of a length in any direction,
    /// the least k with M(q) within k M(p). That of the exact field of tensors may exceed g_r.
    double dir = 1;
};

/// Of `pairs` pairs, either place once as p: half of them anywhere in the domain, the others within
/// ten metric lengths of a source, if there is one. q lies in any direction of metric space, from
/// `shortest_pair` to `longest_pair` metric lengths away, nearer places being as frequent as
/// farther ones on a logarithmic scale. Larger distances would add nothing where the field is
/// continuous: it does not grow faster over a long way than somewhere on it. A jump by a factor of
/// 1 + x counts as up to 1 + x / shortest_pair.
///
/// The same for the same seed, whatever the number of threads. Infinite where an answer is not
/// positive definite.
Steepness steepness(const ControlSpace& space, const Box& domain,
                    std::span<const PointSource> sources, std::uint64_t seed,
                    std::size_t pairs = 40000);
constexpr double shortest_pair = 0.01;
constexpr double longest_pair = 1;

}  // namespace controlspace
