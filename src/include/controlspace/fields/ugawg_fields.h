// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/fields/analytic_field.h"

namespace controlspace {

/// The analytic metrics of the Unstructured Grid Adaptation Working Group's benchmarks
/// (github.com/UGAWG/adapt-benchmarks), in the unit cube; with lengths of at least 0.001 and
/// anisotropy up to 100:1. r, t and z are the directions of cylindrical coordinates around the z
/// axis.
///
///   linear   h_x = h_y = 0.1, h_z = 0.001 + 0.198 |z - 0.5|
///   polar-1  h_r = 0.001 + 0.198 |r - 0.5|, h_t = h_z = 0.1
///   polar-2  h_r and h_z as before, h_t = 0.025 at r = 0.5, rising to 0.1 at a distance of 0.1
AnalyticField ugawg_linear();
AnalyticField ugawg_polar_1();
AnalyticField ugawg_polar_2();

}  // namespace controlspace
