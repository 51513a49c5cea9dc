#pragma once

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// Number of tetrahedra of the lengths that `field` asks for in `domain`, roughly: places between
/// the samples may ask for more.
double estimated_tets(const Box& domain, const ControlSpace& field);

/// Throws InputError if that is more than `most`.
void require_few_tets(const Box& domain, const ControlSpace& field, double most);

}  // namespace controlspace
