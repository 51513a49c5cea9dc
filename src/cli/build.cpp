#include "cli/build.h"

#include <fmt/format.h>

#include "cli/filled_space.h"
#include "cli/standard_output.h"
#include "cli/step_progress.h"
#include "controlspace/error.h"
#include "controlspace/space/control_space_file.h"

namespace controlspace {

void build(const BuildOptions& options) {
    if (!is_control_space(options.output)) {
        throw InputError(fmt::format("cannot save to {}: name a file that ends in .ctrl",
                                     options.output.string()));
    }
    FilledSpace filled;
    {
        StepProgress progress(options.quiet, options.output);
        filled = filled_space(options.input, options.settings, progress.observer());
        progress.started("writing");
        save_control_space(options.output, *filled.space);
    }
    const Footprint footprint = filled.space->footprint();
    print(fmt::format("{}: {} with {} control nodes, {:.3g} MB in memory, {:.3g} MB in the file\n",
                      options.output.string(), filled.space->making()->structure,
                      footprint.control_nodes, static_cast<double>(footprint.bytes_total()) / 1e6,
                      static_cast<double>(std::filesystem::file_size(options.output)) / 1e6));
}

}  // namespace controlspace
