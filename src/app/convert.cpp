#include "app/convert.h"

#include "app/input_study.h"
#include "sources/write_sources.h"

namespace controlspace {

void convert(const ConvertOptions& options) {
    write_sources(options.output, sources_of_input(options.input, options.settings));
}

}  // namespace controlspace
