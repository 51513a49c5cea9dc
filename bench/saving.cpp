// Saving and loading of trees on the paper's sphere at rho = tau = 0.2, as they are after
// gradation: saving/STRUCTURE and loading/STRUCTURE, by the wall clock (real_time), which is what
// one waits for a file; counters give the number of leaves and the size of the file in MB.
//   bench_saving --benchmark_repetitions=5 --benchmark_out=saving.json
#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "controlspace/space/control_space_file.h"

using namespace controlspace;

namespace {

const char* const file = "bench_saving.ctrl";

const ControlSpaceBuilder& graded(const CatalogueEntry& entry) {
    static std::map<std::string, std::unique_ptr<ControlSpaceBuilder>> made;
    auto& space = made[entry.id];
    if (!space) {
        space = entry.make({.domain = {Point::Constant(-1), Point::Constant(1)}, .l_min = 0.2});
        space->insert(sample_sphere({.rho = 0.2}));
        space->grade({.ratio = 1.25});
    }
    return *space;
}

void count(benchmark::State& state) {
    const auto space = load_control_space(file, tree_catalogue());
    state.counters["leaves"] = static_cast<double>(space->footprint().cells);
    state.counters["file_MB"] = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
    std::filesystem::remove(file);
}

void save(benchmark::State& state, const CatalogueEntry& entry) {
    const ControlSpaceBuilder& space = graded(entry);
    for (auto _ : state) save_control_space(file, space);
    count(state);
}

void load(benchmark::State& state, const CatalogueEntry& entry) {
    const ControlSpaceBuilder& space = graded(entry);
    save_control_space(file, space);
    for (auto _ : state) benchmark::DoNotOptimize(load_builder(file, tree_catalogue()));
    count(state);
}

}  // namespace

int main(int argc, char** argv) {
    for (const CatalogueEntry& entry : tree_catalogue()) {
        benchmark::RegisterBenchmark(("saving/" + entry.id).c_str(), save, entry)
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
        benchmark::RegisterBenchmark(("loading/" + entry.id).c_str(), load, entry)
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
