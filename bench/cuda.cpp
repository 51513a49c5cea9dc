// SPDX-License-Identifier: Apache-2.0
// Access time of octrees on a GPU (component cuda) and on one thread of the processor: lengths, or
// metrics where there are tensors, at four million places at random, that lie in the memory of the
// side that answers. Beside them, on the GPU, NanoVDB's dense grids, trilinear, of a float a voxel
// or of six where there are tensors, as coarse as they may be for the mean error of K_oV (or, where
// that takes more than 2 GiB, as fine as that allows).
//
// Names: cuda/STRUCTURE/WORK/gpu, .../gpu-doubles, and .../processor, the compact form in floats.
// Built by --preset cuda, target bench_cuda.
// Counters of NanoVDB: its mean error and that of K_oV, at 20000 places; megabytes on the GPU.
#include <benchmark/benchmark.h>
#include <cuda_runtime_api.h>

#include <algorithm>
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

bool are_lengths(const ControlNodes& nodes) {
    return std::ranges::all_of(nodes.metrics, is_isotropic);
}

/// NanoVDB's dense grids of a work on the GPU, as coarse as their mean error allows; they stay
/// there.
struct NanoOnGpu {
    NanoView view;
    double mean_delta, mean_delta_of_k_ov, megabytes = 0;

    explicit NanoOnGpu(const Work& work);

private:
    template <class Value>
    const nanovdb::NanoGrid<Value>* copied(const NanoHandle& grid) {
        void* memory = nullptr;
        require(cudaMalloc(&memory, grid.size()));
        require(cudaMemcpy(memory, grid.data(), grid.size(), cudaMemcpyHostToDevice));
        megabytes += static_cast<double>(grid.size()) / 1e6;
        return static_cast<const nanovdb::NanoGrid<Value>*>(memory);
    }
};

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

NanoOnGpu::NanoOnGpu(const Work& work) {
    const Probes probes = probes_of(work);
    mean_delta_of_k_ov =
        accuracy(*graded(*find_entry(tree_catalogue(), "K_oV"), work)->build(), probes).mean;
    const auto uniform = uniform_with(mean_delta_of_k_ov, work, probes);
    mean_delta = accuracy(*uniform, probes).mean;
    const ControlNodes nodes = control_nodes(*uniform, Neighbourhood::faces).value();
    const Lattice& lattice = std::get<Lattice>(nodes.graph);
    view = nano_view(uniform->domain(), lattice);
    if (are_lengths(nodes)) {
        view.lengths = copied<float>(dense_lengths(lattice, nodes.metrics));
    } else {
        const DenseNanoGrids grids(lattice, nodes.metrics);
        view.diagonals = copied<nanovdb::Vec3f>(grids.diagonals);
        view.off_diagonals = copied<nanovdb::Vec3f>(grids.off_diagonals);
    }
}

void nanovdb_on_gpu(benchmark::State& state, const NanoOnGpu& nano) {
    time_answers(state, nano.view.lengths != nullptr ? 1 : 6, [&](const double* x, double* out) {
        start_answers(nano.view, x, count, out, nullptr);
        require(cudaGetLastError());
    });
    state.counters["mean_delta"] = nano.mean_delta;
    state.counters["mean_delta_of_K_oV"] = nano.mean_delta_of_k_ov;
    state.counters["megabytes"] = nano.megabytes;
}

void on_processor(benchmark::State& state, const ControlSpace& space) {
    const std::vector<Point> x = random_points(bench_domain(), count, 1);
    const auto time = [&](auto&& answer) {
        for (auto _ : state) answer();
        count_queries(state, count);
    };
    if (are_lengths(control_nodes(space, Neighbourhood::faces).value())) {
        std::vector<double> lengths(count);
        time([&] { space.sample_lengths(x, lengths); });
    } else {
        std::vector<Metric> metrics(count);
        time([&] { space.sample(x, metrics); });
    }
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    for (const Work& work : works()) {
        benchmark::RegisterBenchmark(
            ("cuda/nanovdb-trilinear/" + work.name + "/gpu").c_str(),
            [&work, nano = std::shared_ptr<NanoOnGpu>()](auto& state) mutable {
                if (!nano) nano = std::make_shared<NanoOnGpu>(work);
                nanovdb_on_gpu(state, *nano);
            });
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
