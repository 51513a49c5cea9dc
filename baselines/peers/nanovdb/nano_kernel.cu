#include "baselines/peers/nanovdb/nano_kernel.h"

namespace controlspace {

namespace {

__global__ void answer_all(const NanoView view, const double* x, std::size_t count, double* out) {
    const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
    const int numbers = view.lengths != nullptr ? 1 : 6;
    if (i < count) answer(view, x + 3 * i, out + numbers * i);
}

}  // namespace

void start_answers(const NanoView& view, const double* x, std::size_t count, double* out,
                   cudaStream_t stream) {
    if (count == 0) return;
    constexpr unsigned block = 256;
    answer_all<<<static_cast<unsigned>((count + block - 1) / block), block, 0, stream>>>(
        view, x, count, out);
}

}  // namespace controlspace
