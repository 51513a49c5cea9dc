// Access time of octrees on a GPU (component cuda) and on one thread of the processor: places at
// random, four million, that lie in the memory of the side that answers.
//
// Names: cuda/STRUCTURE/WORK/gpu, .../gpu-doubles, and .../processor, the compact form in floats.
#include <benchmark/benchmark.h>
#include <cuda_runtime_api.h>

#include <cstdlib>
#include <iostream>
#include <vector>

#include "controlspace/cuda/gpu_field.h"
#include "controlspace/error.h"
#include "geometry/random_fractions.h"
#include "works.h"

using namespace controlspace;

namespace {

constexpr std::size_t count = 4 << 20;

void require(cudaError_t error) {
    if (error == cudaSuccess) return;
    std::cerr << "bench_cuda: " << cudaGetErrorString(error) << "\n";
    std::exit(1);
}

std::vector<Point> random_places() {
    RandomFractions random(1);
    std::vector<Point> x(count);
    for (Point& p : x) p = Point(2 * random() - 1, 2 * random() - 1, 2 * random() - 1);
    return x;
}

void on_gpu(benchmark::State& state, const ControlSpace& space, Precision precision) {
    const GpuField gpu(space, precision);
    const std::vector<Point> x = random_places();
    const std::size_t numbers = gpu.answers_lengths() ? 1 : 6;
    void *places = nullptr, *out = nullptr;
    require(cudaMalloc(&places, count * sizeof(Point)));
    require(cudaMalloc(&out, numbers * count * sizeof(double)));
    require(cudaMemcpy(places, x.data(), count * sizeof(Point), cudaMemcpyHostToDevice));
    for (auto _ : state) {
        gpu.start(static_cast<double*>(places), count, static_cast<double*>(out), nullptr);
        require(cudaDeviceSynchronize());
    }
    count_queries(state, count);
    require(cudaFree(places));
    require(cudaFree(out));
}

void on_processor(benchmark::State& state, const ControlSpace& space) {
    const std::vector<Point> x = random_places();
    std::vector<double> lengths(count);
    for (auto _ : state) {
        space.sample_lengths(x, lengths);
        benchmark::DoNotOptimize(lengths.data());
    }
    count_queries(state, count);
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    for (const Work& work : works()) {
        for (const char* id : {"K_oL", "K_oV"}) {
            const auto builder = graded(*find_entry(tree_catalogue(), id), work);
            const std::shared_ptr<ControlSpace> space =
                builder->build({.precision = Precision::floats});
            const std::shared_ptr<ControlSpace> exact =
                builder->build({.precision = Precision::doubles});
            const std::string name = std::string("cuda/") + id + "/" + work.name;
            benchmark::RegisterBenchmark((name + "/gpu").c_str(), [space](auto& state) {
                on_gpu(state, *space, Precision::floats);
            });
            benchmark::RegisterBenchmark((name + "/gpu-doubles").c_str(), [exact](auto& state) {
                on_gpu(state, *exact, Precision::doubles);
            });
            benchmark::RegisterBenchmark((name + "/processor").c_str(),
                                         [space](auto& state) { on_processor(state, *space); });
        }
    }
    try {
        benchmark::RunSpecifiedBenchmarks();
    } catch (const InputError& error) {
        std::cerr << "bench_cuda: " << error.what() << "\n";
        return 1;
    }
}
