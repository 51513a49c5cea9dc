// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "controlspace/sources/sampled_surfaces.h"

namespace controlspace {

/// How sources lie on a surface.
enum class Sampling {
    /// In rows, as sample_sphere and sample_planes make them.
    regular,
    /// Independent, uniform by area.
    random,
    /// Each around one of `cluster_count` centres, which are uniform by area: displacements along
    /// the surface are nearly normal, with standard deviation `cluster_spread` in either direction.
    clustered,
    /// Uniform by area, but no two nearer than h rho (Poisson disks, by dart throwing until little
    /// room is left).
    poisson,
};

inline constexpr int cluster_count = 16;
inline constexpr double cluster_spread = 0.03;  ///< in units of the square root of the area

/// Sources on the same surfaces and with the same metrics as those in rows: as many for `random`
/// and `clustered`, six tenths as many for `poisson`. The same seed gives the same sources on every
/// machine. Errors as there.
std::vector<PointSource> scatter_sphere(const SphereSampling& sphere, Sampling sampling,
                                        std::uint64_t seed);
std::vector<PointSource> scatter_planes(const PlanesSampling& planes, Sampling sampling,
                                        std::uint64_t seed);

}  // namespace controlspace
