// SPDX-License-Identifier: Apache-2.0
// Saving and loading of trees on the paper's sphere at rho = tau = 0.2, as they are after
// gradation: saving/STRUCTURE and loading/STRUCTURE, by the wall clock (real_time), which is what
// one waits for a file; counters give the number of leaves and the size of the file in MB.
//   bench_saving --benchmark_repetitions=5 --benchmark_out=saving.json
#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "controlspace/space/control_space_file.h"
#include "works.h"

using namespace controlspace;

namespace {

const char* const file = "bench_saving.ctrl";

const ControlSpaceBuilder& made(const CatalogueEntry& entry) {
    static std::map<std::string, std::unique_ptr<ControlSpaceBuilder>> all;
    auto& builder = all[entry.id];
    if (!builder) builder = graded(entry, {"", 0.2, {.rho = 0.2}});
    return *builder;
}

void count(benchmark::State& state) {
    const auto space = load_control_space(file, tree_catalogue());
    state.counters["leaves"] = static_cast<double>(space->footprint().cells);
    state.counters["file_MB"] = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
    std::filesystem::remove(file);
}

void save(benchmark::State& state, const CatalogueEntry& entry) {
    const ControlSpaceBuilder& space = made(entry);
    for (auto _ : state) save_control_space(file, space);
    count(state);
}

void load(benchmark::State& state, const CatalogueEntry& entry) {
    const ControlSpaceBuilder& space = made(entry);
    save_control_space(file, space);
    for (auto _ : state) benchmark::DoNotOptimize(load_builder(file, tree_catalogue()));
    count(state);
}

}  // namespace

int main(int argc, char** argv) {
    for (const CatalogueEntry& entry : tree_catalogue()) {
        for (const auto& [name, run] :
             {std::pair("saving/", &save), std::pair("loading/", &load)}) {
            benchmark::RegisterBenchmark((name + entry.id).c_str(), run, entry)
                ->Unit(benchmark::kMillisecond)
                ->MeasureProcessCPUTime()
                ->UseRealTime();
        }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
