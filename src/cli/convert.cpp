// SPDX-License-Identifier: Apache-2.0
// The command `convert`: writes the sources of one file in another format.
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "controlspace/io/read_sources.h"
#include "refuse.h"

namespace controlspace {

Action add_convert(Options& options) {
    struct Convert : Job {
        std::filesystem::path out;
    };
    const auto job = std::make_shared<Convert>();
    options.add({"IN", "FILE", source_formats_help(), "", true}, job->input);
    options.add({"OUT", "FILE",
                 "File to write: .csv; .mesh, .sol, .meshb or .solb, which makes both a mesh and a "
                 "solution; .pos; .vtu, .vtp"},
                job->out);
    options.add({"-o,--output", "FILE", "The same as OUT"}, job->output);
    options.exclude("--output", "OUT");
    add_reading_options(options, *job);
    return [job](const std::string&) {
        const std::filesystem::path& output = job->out.empty() ? job->output : job->out;
        if (output.empty()) refuse("no OUT: name the file to write");
        require_output(output, files_named(job->input));
        StepProgress progress(job->quiet, output);
        progress.started("reading");
        const auto sources = sources_of_input(job->input, given_settings(job->given));
        progress.started("writing");
        write_sources(output, sources);
        return 0;
    };
}

}  // namespace controlspace
