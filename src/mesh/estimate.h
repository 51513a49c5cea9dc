// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Estimated number of tetrahedra of the lengths that `field` requests in `domain`, from samples:
/// shorter lengths between them are missed.
double estimated_tets(const Box& domain, const ControlSpace& field);

/// Throws InputError if that is more than `most`.
void require_few_tets(const Box& domain, const ControlSpace& field, double most);

}  // namespace controlspace
