#pragma once

#include <cstdint>
#include <vector>

#include "controlspace/sources/sampled_surfaces.h"

namespace controlspace {

/// How sources lie on a surface.
enum class Sampling {
    /// In rows, as sample_sphere and sample_planes make them.
    regular,
    /// Each anywhere, with equal chance for equal areas.
    random,
    /// Each around one of `cluster_count` places, which are anywhere: its distance from it is
    /// nearly normal, `cluster_spread` in standard deviation along either direction.
    clustered,
    /// Anywhere, but no two nearer than h rho (Poisson disks). Every place is tried so often that
    /// little room is left.
    poisson,
};

inline constexpr int cluster_count = 16;
inline constexpr double cluster_spread = 0.03;  ///< in units of the square root of the area

/// Sources on the same surfaces and with the same metrics as those in rows; of `random` and
/// `clustered` as many too, of `poisson` six tenths. The same
/// for the same seed. Errors as there.
std::vector<PointSource> scatter_sphere(const SphereSampling& sphere, Sampling sampling,
                                        std::uint64_t seed);
std::vector<PointSource> scatter_planes(const PlanesSampling& planes, Sampling sampling,
                                        std::uint64_t seed);

}  // namespace controlspace
