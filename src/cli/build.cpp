// SPDX-License-Identifier: Apache-2.0
// The command `build`: builds and grades one structure, and saves it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/options.h"
#include "cli/standard_output.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/space/control_space_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

// A .vdb holds floats of a structure with VdbFiles; a study file says itself what it makes.
void set_what_vdb_holds(Job& job) {
    const auto has_files = [](const CatalogueEntry& entry) { return entry.has<VdbFiles>(); };
    const auto rows = structures();
    std::vector<std::string> able;
    for (const CatalogueEntry& row : rows) {
        if (has_files(row)) able.push_back(row.id);
    }
    if (able.empty()) refuse("this program has no OpenVDB: name a .ctrl");
    for (const std::string& id : job.given["structures"]) {
        const CatalogueEntry* row = find_entry(rows, id);
        if (row != nullptr && !has_files(*row)) {
            refuse("{} cannot be saved to a .vdb: name a .ctrl, or {}", id, fmt::join(able, ", "));
        }
    }
    if (job.input.extension() == ".toml") return;
    if (job.given["structures"].empty()) job.given["structures"] = {able.front()};
    if (job.given["precision"].empty()) job.given["precision"] = {"float"};
}

int build(Job job) {
    const std::filesystem::path& output = job.output;
    if (output.extension() == ".vdb") {
        set_what_vdb_holds(job);
    } else if (output.extension() != ".ctrl") {
        refuse("cannot save to {}: name a file that ends in .ctrl, or .vdb", output.string());
    }
    const FilledSpace filled = filled_space(
        job, "writing", [&](const auto& made, auto&) { save_control_space(output, *made.space); });
    const Footprint footprint = filled.space->footprint();
    print(fmt::format("{}: {} with {} control nodes, {:.3g} MB in memory{}\n", output.string(),
                      filled.structure, footprint.control_nodes,
                      static_cast<double>(footprint.bytes_total()) / 1e6,
                      size_of_file(output, ", ")));
    return report_remark(filled);
}

}  // namespace

Action add_build(Options& options) {
    const auto job = std::make_shared<Job>();
    add_study_input(options, job->input);
    options.add({"-o,--output", "FILE",
                 "File to write: .ctrl, or, of openvdb-tiles and openvdb-bricks, their lengths in "
                 "floats in a .vdb",
                 "", true},
                job->output);
    add_making_options(options, *job);
    return [job](const std::string&) { return build(*job); };
}

}  // namespace controlspace
