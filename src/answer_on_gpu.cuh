// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace controlspace {

/// Threads of a block, for kernels that call `answer_places`.
constexpr unsigned block_size = 256;

/// Calls answer(i, to) for all places of a batch, i < count, from the threads of a grid of blocks:
/// it writes `numbers` numbers to `to`, which go to `out` one place after the other. Several of a
/// place are put together in the block, so that threads write side by side.
template <int numbers, class Answer>
__device__ void answer_places(std::size_t count, double* out, const Answer& answer) {
    __shared__ double answers[numbers == 1 ? 1 : block_size * numbers];
    const std::size_t step = std::size_t{gridDim.x} * block_size;
    for (std::size_t first = std::size_t{blockIdx.x} * block_size; first < count; first += step) {
        const std::size_t i = first + threadIdx.x;
        if constexpr (numbers == 1) {
            if (i < count) answer(i, out + i);
        } else {
            if (i < count) answer(i, answers + numbers * threadIdx.x);
            __syncthreads();
            const std::size_t left = numbers * (count - first);
            for (unsigned n = threadIdx.x; n < numbers * block_size && n < left; n += block_size) {
                out[numbers * first + n] = answers[n];
            }
            __syncthreads();
        }
    }
}

/// Blocks of such a grid.
inline unsigned blocks_for(std::size_t count) {
    constexpr std::size_t most = 1 << 20;
    const std::size_t blocks = (count + block_size - 1) / block_size;
    return static_cast<unsigned>(blocks < most ? blocks : most);
}

}  // namespace controlspace
