// SPDX-License-Identifier: Apache-2.0
#include "answer_on_gpu.cuh"
#include "cuda/octree_kernels.h"

namespace controlspace {

namespace {

// Two kernels, since leaves of one value need fewer registers, so that more places are on their
// way.
template <int numbers, bool of_corners, class Number>
__global__ void answer_all(const OctreeView<Number> tree, const double* x, std::size_t count,
                           double* out) {
    answer_places<numbers>(count, out, [&](std::size_t i, double* to) {
        if constexpr (of_corners) {
            answer_of_corners<numbers>(tree, x + 3 * i, to);
        } else {
            answer_of_leaf<numbers>(tree, x + 3 * i, to);
        }
    });
}

}  // namespace

template <class Number>
void start_answers(const OctreeView<Number>& tree, int numbers, const double* x, std::size_t count,
                   double* out, cudaStream_t stream) {
    if (count == 0) return;
    const auto start = [&](auto kernel) {
        kernel<<<blocks_for(count), block_size, 0, stream>>>(tree, x, count, out);
    };
    if (tree.leaves == nullptr) {
        start(numbers == 1 ? answer_all<1, false, Number> : answer_all<6, false, Number>);
    } else {
        start(numbers == 1 ? answer_all<1, true, Number> : answer_all<6, true, Number>);
    }
}

template void start_answers(const OctreeView<float>&, int, const double*, std::size_t, double*,
                            cudaStream_t);
template void start_answers(const OctreeView<double>&, int, const double*, std::size_t, double*,
                            cudaStream_t);

}  // namespace controlspace
