#include "cuda/octree_kernels.h"

namespace controlspace {

namespace {

template <int numbers, class Number>
__global__ void answer_all(const OctreeView<Number> tree, const double* x, std::size_t count,
                           double* out) {
    const std::size_t threads = std::size_t{gridDim.x} * blockDim.x;
    for (std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x; i < count;
         i += threads) {
        answer<numbers>(tree, x + 3 * i, out + numbers * i);
    }
}

}  // namespace

template <class Number>
void start_answers(const OctreeView<Number>& tree, int numbers, const double* x, std::size_t count,
                   double* out, cudaStream_t stream) {
    if (count == 0) return;
    constexpr unsigned block = 256;
    constexpr std::size_t most_blocks = 1 << 20;
    const std::size_t blocks = (count + block - 1) / block;
    const auto grid = static_cast<unsigned>(blocks < most_blocks ? blocks : most_blocks);
    if (numbers == 1) {
        answer_all<1><<<grid, block, 0, stream>>>(tree, x, count, out);
    } else {
        answer_all<6><<<grid, block, 0, stream>>>(tree, x, count, out);
    }
}

template void start_answers(const OctreeView<float>&, int, const double*, std::size_t, double*,
                            cudaStream_t);
template void start_answers(const OctreeView<double>&, int, const double*, std::size_t, double*,
                            cudaStream_t);

}  // namespace controlspace
