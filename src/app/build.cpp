#include "app/build.h"

#include <fmt/format.h>

#include "app/filled_space.h"
#include "app/standard_output.h"
#include "error.h"
#include "spaces/control_space_file.h"

namespace controlspace {

void build(const BuildOptions& options) {
    if (!is_control_space(options.output)) {
        throw InputError(fmt::format("cannot save to {}: name a file that ends in .ctrl",
                                     options.output.string()));
    }
    const FilledSpace filled = filled_space(options.input, options.settings);
    save_control_space(options.output, *filled.space);
    const Footprint footprint = filled.space->footprint();
    print(fmt::format("{}: {} with {} control nodes, {:.1f} MB in memory, {:.1f} MB in the file\n",
                      options.output.string(), filled.space->making()->structure,
                      footprint.control_nodes, static_cast<double>(footprint.bytes_total()) / 1e6,
                      static_cast<double>(std::filesystem::file_size(options.output)) / 1e6));
}

}  // namespace controlspace
