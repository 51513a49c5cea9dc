#include "cuda/octree_kernels.h"

namespace controlspace {

namespace {

constexpr unsigned block = 256;

// Two kernels, since leaves of one value need fewer registers, so that more places are on their
// way.
template <int numbers, bool of_corners, class Number>
__global__ void answer_all(const OctreeView<Number> tree, const double* x, std::size_t count,
                           double* out) {
    // Metrics are put together here, so that threads write side by side.
    __shared__ double answers[numbers == 1 ? 1 : block * numbers];
    const auto answer = [&](std::size_t i, double* to) {
        if constexpr (of_corners) {
            answer_of_corners<numbers>(tree, x + 3 * i, to);
        } else {
            answer_of_leaf<numbers>(tree, x + 3 * i, to);
        }
    };
    const std::size_t step = std::size_t{gridDim.x} * block;
    for (std::size_t first = std::size_t{blockIdx.x} * block; first < count; first += step) {
        const std::size_t i = first + threadIdx.x;
        if constexpr (numbers == 1) {
            if (i < count) answer(i, out + i);
        } else {
            if (i < count) answer(i, answers + numbers * threadIdx.x);
            __syncthreads();
            const std::size_t left = numbers * (count - first);
            for (unsigned n = threadIdx.x; n < numbers * block && n < left; n += block) {
                out[numbers * first + n] = answers[n];
            }
            __syncthreads();
        }
    }
}

}  // namespace

template <class Number>
void start_answers(const OctreeView<Number>& tree, int numbers, const double* x, std::size_t count,
                   double* out, cudaStream_t stream) {
    if (count == 0) return;
    constexpr std::size_t most_blocks = 1 << 20;
    const std::size_t blocks = (count + block - 1) / block;
    const auto grid = static_cast<unsigned>(blocks < most_blocks ? blocks : most_blocks);
    const auto start = [&](auto kernel) {
        kernel<<<grid, block, 0, stream>>>(tree, x, count, out);
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
