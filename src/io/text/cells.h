#pragma once

#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// The cells of any structure, each once: the leaves of a tree, the cells of a grid, as far as
/// they lie in the domain. Found by asking for the element at places, so that nothing needs to be
/// known of the structure; in ascending order of their low corners, x first.
std::vector<Box> elements_of(const ControlSpace& space);

}  // namespace controlspace
