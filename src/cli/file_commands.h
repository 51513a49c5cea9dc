#pragma once

#include "cli/build.h"
#include "cli/convert.h"
#include "cli/info.h"
#include "cli/query.h"
#include "cli/setting_options.h"

namespace controlspace {

// Commands that read files and say or write what is in them. `given` takes what is given of the
// settings; it and `options` must outlive the parsing.

CLI::App* add_info(CLI::App& app, InfoOptions& options, WordsByKey& given);
CLI::App* add_convert(CLI::App& app, ConvertOptions& options, WordsByKey& given);
CLI::App* add_build(CLI::App& app, BuildOptions& options, WordsByKey& given);
CLI::App* add_query(CLI::App& app, QueryOptions& options, WordsByKey& given);

}  // namespace controlspace
