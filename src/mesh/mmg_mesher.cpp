// SPDX-License-Identifier: Apache-2.0
#include "mesh/mmg_mesher.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/mesh/mesh_files.h"
#include "controlspace/space/sample_parallel.h"
#include "files/child_process.h"
#include "io/text/medit.h"
#include "measure/stopwatch.h"
#include "mesh/size_query.h"
#include "refuse.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

std::vector<Metric> metrics_at(const TetMesh& mesh, const ControlSpace& field) {
    std::vector<Metric> metrics = sample_parallel(field, mesh.vertices);
    for (std::size_t i = 0; i < metrics.size(); ++i) require_metric(metrics[i], mesh.vertices[i]);
    return metrics;
}

std::string reason(const ChildOutcome& outcome, const MmgOptions& options) {
    if (!outcome.is_known) return "was collected by another part of this program";
    if (outcome.timed_out) return fmt::format("took longer than {} s", options.time_limit_s);
    if (outcome.signal != 0) return fmt::format("was ended by signal {}", outcome.signal);
    if (outcome.status != 0) return fmt::format("failed with status {}", outcome.status);
    return "left no mesh that can be read";
}

/// One call of MMG on `mesh`.
TetMesh remesh(const TetMesh& mesh, const std::vector<Metric>& metrics, const fs::path& program,
               const MmgOptions& options, MeshCost& cost) {
    TemporaryFolder folder(options.folder, "mmg");
    const fs::path log = folder.path() / "log", out = folder.path() / "out.mesh";
    write_medit_mesh(folder.path() / "in.mesh", mesh);
    // Of sizes MMG would make a mesh by other rules.
    write_medit_solution(folder.path() / "in.sol", metrics, /*keep_tensors=*/true);
    std::vector<std::string> words{program.string(), "-v",   "1",      "-hgrad", "-1",      "-in",
                                   "in.mesh",        "-sol", "in.sol", "-out",   "out.mesh"};
    if (options.hausdorff > 0) {
        words.insert(words.end(), {"-hausd", fmt::format("{}", options.hausdorff)});
    }
    const Stopwatch watch;
    const ChildOutcome outcome = run_child(words, folder.path(), log, options.time_limit_s);
    cost += {.seconds = watch.seconds(),
             .processor_seconds = outcome.processor_seconds,
             .peak_bytes = outcome.peak_bytes};
    std::string unreadable;
    if (outcome.succeeded()) {
        try {
            return read_medit_mesh(out);
        } catch (const InputError& error) {
            unreadable = fmt::format(" ({})", error.what());
        }
    }
    folder.keep();
    constexpr std::size_t enough = 3;
    const std::string said = last_lines(log, enough);
    refuse("MMG {}{}: {} (its files: {})", reason(outcome, options), unreadable,
           said.empty() ? "it printed nothing" : said, folder.path().string());
}

}  // namespace

fs::path find_mmg() {
    for (const char* name : {"mmg3d_O3", "mmg3d"}) {
        if (fs::path found = find_program(name); !found.empty()) return found;
    }
    return {};
}

fs::path require_mmg(const MmgOptions& options) {
    if (options.program.empty()) {
        fs::path found = find_mmg();
        if (found.empty()) refuse("MMG is missing: there is no mmg3d_O3 in PATH; name it by --mmg");
        return found;
    }
    fs::path found = find_program(options.program.string());
    if (found.empty()) {
        refuse_at(options.program, "no program that can be run: name MMG's mmg3d_O3");
    }
    return found;
}

MeshRun mesh_with_mmg(const TetMesh& start, const ControlSpace& field, const MmgOptions& options) {
    if (options.rounds < 1) refuse("{} rounds of MMG: give 1 or more", options.rounds);
    if (!(options.factor > 0 && std::isfinite(options.factor))) {
        refuse("factor {} of lengths: give a positive one", options.factor);
    }
    if (!(options.time_limit_s > 0)) {
        refuse("a time limit of {} s: give a positive one", options.time_limit_s);
    }
    const fs::path program = require_mmg(options);
    MeshRun run;
    run.mesh = start;
    for (int round = 0; round < options.rounds; ++round) {
        const Stopwatch watch;
        std::vector<Metric> metrics = metrics_at(run.mesh, field);
        const double seconds = watch.seconds();
        run.cost += {seconds, seconds, metrics.size(), seconds};
        for (Metric& m : metrics) m = options.factor * m;
        run.mesh = remesh(run.mesh, metrics, program, options, run.cost);
    }
    return run;
}

}  // namespace controlspace
