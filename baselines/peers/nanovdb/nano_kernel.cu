// SPDX-License-Identifier: Apache-2.0
#include "baselines/peers/nanovdb/nano_kernel.h"
#include "src/answer_on_gpu.cuh"

namespace controlspace {

namespace {

template <int numbers>
__global__ void answer_all(const NanoView view, const double* x, std::size_t count, double* out) {
    answer_places<numbers>(count, out, [&](std::size_t i, double* to) {
        if constexpr (numbers == 1) {
            answer_length(view, x + 3 * i, to);
        } else {
            answer_metric(view, x + 3 * i, to);
        }
    });
}

}  // namespace

void start_answers(const NanoView& view, const double* x, std::size_t count, double* out,
                   cudaStream_t stream) {
    if (count == 0) return;
    const auto kernel = view.lengths != nullptr ? answer_all<1> : answer_all<6>;
    kernel<<<blocks_for(count), block_size, 0, stream>>>(view, x, count, out);
}

}  // namespace controlspace
