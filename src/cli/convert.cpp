#include "cli/convert.h"

#include <string>
#include <vector>

#include "cli/input_study.h"
#include "controlspace/io/read_sources.h"
#include "io/text/write_sources.h"

#ifdef CONTROLSPACE_VTK
#include "controlspace/io/write_vtk.h"
#endif

namespace controlspace {

void convert(const ConvertOptions& options) {
    const std::vector<PointSource> sources = sources_of_input(options.input, options.settings);
#ifdef CONTROLSPACE_VTK
    const std::string ending = lower_case_extension(options.output);
    if (ending == ".vtu" || ending == ".vtp") return write_vtk_sources(options.output, sources);
#endif
    write_sources(options.output, sources);
}

}  // namespace controlspace
