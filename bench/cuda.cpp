// Access time of octrees on a GPU (component cuda) and on one thread of the processor: places at
// random, four million, that lie in the memory of the side that answers. Beside them, on the GPU,
// NanoVDB's dense grids of six floats a voxel, trilinear, as coarse as they may be for the mean
// error of K_oV (or, where that takes more than 2 GiB, as fine as that allows).
//
// Names: cuda/STRUCTURE/WORK/gpu, .../gpu-doubles, and .../processor, the compact form in floats.
// Built by --preset peers -D CONTROLSPACE_CUDA=ON -D CONTROLSPACE_BENCHMARKS=ON, target bench_cuda.
// Counters of NanoVDB: its mean error and that of K_oV, at 20000 places; megabytes on the GPU.
#include <benchmark/benchmark.h>
#include <cuda_runtime_api.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <variant>
#include <vector>

#include "baselines/peers/nanovdb/dense_grid.h"
#include "baselines/peers/nanovdb/nano_kernel.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/cuda/gpu_field.h"
#include "controlspace/error.h"
#include "controlspace/measure/access_time.h"
#include "controlspace/measure/accuracy.h"
#include "controlspace/space/control_nodes.h"
#include "works.h"

using namespace controlspace;

namespace {

constexpr std::size_t count = 4 << 20;

void require(cudaError_t error) {
    if (error == cudaSuccess) return;
    std::cerr << "bench_cuda: " << cudaGetErrorString(error) << "\n";
    std::exit(1);
}

/// start(x, out) starts all answers, `numbers` for each place.
template <class Start>
void time_answers(benchmark::State& state, std::size_t numbers, Start&& start) {
    const std::vector<Point> x = random_points(bench_domain(), count, 1);
    void *places = nullptr, *out = nullptr;
    require(cudaMalloc(&places, count * sizeof(Point)));
    require(cudaMalloc(&out, numbers * count * sizeof(double)));
    require(cudaMemcpy(places, x.data(), count * sizeof(Point), cudaMemcpyHostToDevice));
    for (auto _ : state) {
        start(static_cast<double*>(places), static_cast<double*>(out));
        require(cudaDeviceSynchronize());
    }
    count_queries(state, count);
    require(cudaFree(places));
    require(cudaFree(out));
}

void on_gpu(benchmark::State& state, const ControlSpace& space, Precision precision) {
    const GpuField gpu(space, precision);
    time_answers(state, gpu.answers_lengths() ? 1 : 6,
                 [&](const double* x, double* out) { gpu.start(x, count, out, nullptr); });
}

const nanovdb::NanoGrid<nanovdb::Vec3f>* copied_to_gpu(
    const nanovdb::GridHandle<nanovdb::HostBuffer>& grid) {
    void* memory = nullptr;
    require(cudaMalloc(&memory, grid.size()));
    require(cudaMemcpy(memory, grid.data(), grid.size(), cudaMemcpyHostToDevice));
    return static_cast<const nanovdb::NanoGrid<nanovdb::Vec3f>*>(memory);
}

Probes probes_of(const Work& work) {
    const std::vector<PointSource> sources = sample_sphere(work.sampling);
    const SpaceOptions options = options_of(work, sources);
    return make_probes(*exact_reference(sources, options.ratio, largest_metric(options)),
                       random_points(bench_domain(), 20000, 2));
}

/// The coarsest of uniform grids, each a tenth finer, whose mean error is at most `delta`.
std::unique_ptr<ControlSpace> uniform_with(double delta, const Work& work, const Probes& probes) {
    constexpr double most_nodes = 2.0 * (1 << 30) / 24;
    for (double voxel = 0.125;; voxel /= 1.1) {
        auto grid =
            graded(*find_entry(structures(), "uniform-trilinear"), work, SplitRule::middle, voxel)
                ->build();
        const double finer_nodes = std::pow(2 / (voxel / 1.1) + 1, 3);
        if (finer_nodes > most_nodes || accuracy(*grid, probes).mean <= delta) return grid;
    }
}

void nanovdb_on_gpu(benchmark::State& state, const Work& work) {
    const Probes probes = probes_of(work);
    const double delta =
        accuracy(*graded(*find_entry(structures(), "K_oV"), work)->build(), probes).mean;
    const auto uniform = uniform_with(delta, work, probes);
    const ControlNodes nodes = control_nodes(*uniform, Neighbourhood::faces).value();
    const Lattice& lattice = std::get<Lattice>(nodes.graph);
    const DenseNanoGrids grids(lattice, nodes.metrics);
    NanoView view = nano_view(uniform->domain(), lattice);
    const auto* const diagonals = view.diagonals = copied_to_gpu(grids.diagonals);
    const auto* const off_diagonals = view.off_diagonals = copied_to_gpu(grids.off_diagonals);
    time_answers(state, 6, [&](const double* x, double* out) {
        start_answers(view, x, count, out, nullptr);
        require(cudaGetLastError());
    });
    state.counters["mean_delta"] = accuracy(*uniform, probes).mean;
    state.counters["mean_delta_of_K_oV"] = delta;
    state.counters["megabytes"] =
        static_cast<double>(grids.diagonals.size() + grids.off_diagonals.size()) / 1e6;
    require(cudaFree(const_cast<nanovdb::NanoGrid<nanovdb::Vec3f>*>(diagonals)));
    require(cudaFree(const_cast<nanovdb::NanoGrid<nanovdb::Vec3f>*>(off_diagonals)));
}

void on_processor(benchmark::State& state, const ControlSpace& space) {
    const std::vector<Point> x = random_points(bench_domain(), count, 1);
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
        benchmark::RegisterBenchmark(("cuda/nanovdb-trilinear/" + work.name + "/gpu").c_str(),
                                     [&work](auto& state) { nanovdb_on_gpu(state, work); });
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
