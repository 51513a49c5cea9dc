// SPDX-License-Identifier: Apache-2.0
#include "trees/packing/frozen_quadratic.h"

namespace controlspace {

template std::unique_ptr<ControlSpace> freeze_quadratic(const Topology<OctreeNode>&,
                                                        std::span<const Metric>,
                                                        const QuadraticRule&, Precision);

}  // namespace controlspace
