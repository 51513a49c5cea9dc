// The command `convert`: writes the sources of one file in another format.
#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/formats.h"
#include "cli/input_study.h"
#include "cli/options.h"
#include "controlspace/io/read_sources.h"

namespace controlspace {

Action add_convert(Options& options) {
    struct Convert {
        std::filesystem::path input, output;
        WordsByKey given;
    };
    const auto job = std::make_shared<Convert>();
    options.add({"IN", "FILE", source_formats_help(), "", true}, job->input);
    options.add({"OUT", "FILE",
                 "File to write: .csv; .mesh, .sol, .meshb or .solb, which makes both a mesh and a "
                 "solution; .pos; .vtu, .vtp",
                 "", true},
                job->output);
    add_reading_options(options, job->given);
    return [job](const std::string&) {
        require_no_input(job->output, {job->input});
        write_sources(job->output, sources_of_input(job->input, given_settings(job->given)));
        return 0;
    };
}

}  // namespace controlspace
