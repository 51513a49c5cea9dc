#pragma once

#include "app/build.h"
#include "app/convert.h"
#include "app/info.h"
#include "app/query.h"
#include "app/setting_options.h"

namespace controlspace {

// Commands that read files and say or write what is in them. `given` takes what is given of the
// settings; it and `options` must outlive the parsing.

CLI::App* add_info(CLI::App& app, InfoOptions& options, WordsByKey& given);
CLI::App* add_convert(CLI::App& app, ConvertOptions& options, WordsByKey& given);
CLI::App* add_build(CLI::App& app, BuildOptions& options, WordsByKey& given);
CLI::App* add_query(CLI::App& app, QueryOptions& options, WordsByKey& given);

}  // namespace controlspace
