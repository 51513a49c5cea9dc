// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cuda_runtime_api.h>

#include "baselines/peers/nanovdb/nano_view.h"

namespace controlspace {

/// Starts, on the current device, the answers at `count` places: x, y and z of each, all in the
/// device's memory, to one number each in `out` where the view has lengths, or else to six.
void start_answers(const NanoView& view, const double* x, std::size_t count, double* out,
                   cudaStream_t stream);

}  // namespace controlspace
