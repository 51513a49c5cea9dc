// SPDX-License-Identifier: Apache-2.0
// The command `build`: builds and grades one structure, and saves it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/filled_space.h"
#include "cli/options.h"
#include "cli/standard_output.h"
#include "controlspace/space/control_space_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

int build(const Job& job) {
    const std::filesystem::path& output = job.output;
    if (output.extension() != ".ctrl") {
        refuse("cannot save to {}: name a file that ends in .ctrl", output.string());
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
    options.add({"-o,--output", "FILE.ctrl", "File to write", "", true}, job->output);
    add_making_options(options, *job);
    return [job](const std::string&) { return build(*job); };
}

}  // namespace controlspace
