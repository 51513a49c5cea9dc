// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "controlspace/space/control_space.h"

namespace controlspace {

/// The intersection of `fields`, one after the other in their order, over the intersection of their
/// domains: for a mesh that must meet an analytic field and discrete sources at once. None of them
/// is graded first, so an analytic field that grows faster than the sources' cones keeps its
/// growth. Throws InputError if there are no fields.
std::unique_ptr<ControlSpace> mixture(std::vector<std::shared_ptr<const ControlSpace>> fields);

}  // namespace controlspace
