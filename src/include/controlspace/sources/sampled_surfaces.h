// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Metrics of sampled surfaces (paper §5.1): length `h s_a` along the surface and `h s_a s_n`
/// across it; samples are `h rho` apart, whatever s_a and s_n. [s_a, s_n] = [2, 1] of the paper is
/// isotropic 0.03, and [4, 0.25] is 0.015 across and 0.06 along.
struct SphereSampling {
    Point centre = Point::Zero();
    double radius = 0.8;
    double h = 0.015;
    double s_a = 2;
    double s_n = 1;
    double rho = 1;
};

/// Two planes in [-1,1]^3, (-0.5, u, v) and (u, -0.2 + slope u, v) with u, v in [-1,1]. Slope 0
/// crosses the first plane at a right angle; 0.8, the largest that stays within the cube, at 51
/// degrees. The paper uses the slopes 0.0 and 0.2 (§4).
struct PlanesSampling {
    double h = 0.015;
    double s_a = 2;
    double s_n = 1;
    double rho = 1;
    double slope = 0;  ///< -0.8 to 0.8
};

/// Most sources that sampling makes; more is refused as a typing error.
inline constexpr double most_samples = 1e8;

/// Sources on a sphere, as published (there around the origin): the equator, then pairs of
/// latitudes towards the poles, then the two poles. Latitudes go by quadrants that start at x = 0
/// and stop one step before y = 0: sources at x = 0 are there twice, and at y = 0 two steps meet
/// without one. 36186 for the defaults. Throws InputError for values that are not positive or make
/// too many.
std::vector<PointSource> sample_sphere(const SphereSampling& sampling);

/// Sources on both planes, the first plane first, in rows along u, each row ending at u = 1.
/// Errors as for the sphere.
std::vector<PointSource> sample_planes(const PlanesSampling& sampling);

}  // namespace controlspace
