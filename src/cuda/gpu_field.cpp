// SPDX-License-Identifier: Apache-2.0
#include "controlspace/cuda/gpu_field.h"

#include <cuda_runtime_api.h>

#include <algorithm>
#include <variant>
#include <vector>

#include "controlspace/metric/stored_metrics.h"
#include "cuda/octree_arrays.h"
#include "cuda/octree_kernels.h"
#include "refuse.h"

namespace controlspace {

namespace {

void require(cudaError_t error) {
    if (error != cudaSuccess) refuse("the GPU cannot be used: {}", cudaGetErrorString(error));
}

struct FreeOnDevice {
    void operator()(void* memory) const { cudaFree(memory); }
};
template <class T>
using OnDevice = std::unique_ptr<T, FreeOnDevice>;

template <class T>
OnDevice<T> allocate(std::size_t count) {
    void* memory = nullptr;
    require(cudaMalloc(&memory, std::max<std::size_t>(1, count) * sizeof(T)));
    return OnDevice<T>(static_cast<T*>(memory));
}

template <class T>
OnDevice<T> copied(const T* data, std::size_t count) {
    auto memory = allocate<T>(count);
    require(cudaMemcpy(memory.get(), data, count * sizeof(T), cudaMemcpyHostToDevice));
    return memory;
}

}  // namespace

struct GpuField::Copy {
    int numbers;
    std::vector<OnDevice<void>> arrays;
    std::variant<OctreeView<float>, OctreeView<double>> view;

    template <class Number>
    explicit Copy(const OctreeArrays<Number>& octree)
        : numbers(octree.numbers()), view(octree.view([&](const auto& array) {
              auto on_device = copied(array.data(), array.size());
              const auto* const pointer = on_device.get();
              arrays.emplace_back(on_device.release());
              return pointer;
          })) {}
};

GpuField::GpuField(const ControlSpace& field, Precision precision) {
    require_valid(precision);
    if (precision == Precision::log16 || precision == Precision::log8) {
        refuse("a GPU holds no codes of lengths: use floats or doubles");
    }
    copy_ = precision == Precision::floats ? std::make_unique<Copy>(OctreeArrays<float>(field))
                                           : std::make_unique<Copy>(OctreeArrays<double>(field));
}
GpuField::~GpuField() = default;
GpuField::GpuField(GpuField&&) noexcept = default;
GpuField& GpuField::operator=(GpuField&&) noexcept = default;

bool GpuField::answers_lengths() const { return copy_->numbers == 1; }

void GpuField::start(const double* x, std::size_t count, double* out, CUstream_st* stream) const {
    std::visit(
        [&](const auto& view) { start_answers(view, copy_->numbers, x, count, out, stream); },
        copy_->view);
    require(cudaGetLastError());
}

void GpuField::answer(std::span<const Point> x, void* out) const {
    static_assert(sizeof(Point) == 3 * sizeof(double) && sizeof(Metric) == 6 * sizeof(double));
    const std::size_t numbers = x.size() * static_cast<std::size_t>(copy_->numbers);
    const auto places = copied(x.data(), x.size());
    const auto answers = allocate<double>(numbers);
    start(places.get()->data(), x.size(), answers.get(), nullptr);
    require(cudaMemcpy(out, answers.get(), numbers * sizeof(double), cudaMemcpyDeviceToHost));
}

void GpuField::sample_lengths(std::span<const Point> x, std::span<double> out) const {
    if (!answers_lengths()) {
        refuse("a field of tensors on a GPU answers no lengths: ask for metrics");
    }
    answer(x, out.data());
}

void GpuField::sample(std::span<const Point> x, std::span<Metric> out) const {
    if (!answers_lengths()) return answer(x, out.data());
    std::vector<double> lengths(x.size());
    answer(x, lengths.data());
    std::ranges::transform(lengths, out.begin(), &Metric::isotropic);
}

}  // namespace controlspace
