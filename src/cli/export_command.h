#pragma once

#include "cli/export.h"
#include "cli/setting_options.h"

namespace controlspace {

/// The command `export`. `given` takes what is given of the settings; it and `options` must outlive
/// the parsing.
CLI::App* add_export(CLI::App& app, ExportOptions& options, WordsByKey& given);

}  // namespace controlspace
