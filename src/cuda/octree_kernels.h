// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cuda_runtime_api.h>

#include "cuda/octree_view.h"

namespace controlspace {

/// Starts, on the current device, the answers at `count` places: x, y and z of each, all in the
/// device's memory, to `numbers` (1 or 6) each in `out`.
template <class Number>
void start_answers(const OctreeView<Number>& tree, int numbers, const double* x, std::size_t count,
                   double* out, cudaStream_t stream);

}  // namespace controlspace
