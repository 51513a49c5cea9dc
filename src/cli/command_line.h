#pragma once

#include <string>
#include <variant>

#include "cli/build.h"
#include "cli/compare.h"
#include "cli/convert.h"
#include "cli/export.h"
#include "cli/info.h"
#include "cli/mesh.h"
#include "cli/query.h"

namespace controlspace {

/// --help or --version: to be printed as it is.
struct TextCommand {
    std::string text;
};
struct ListCommand {};

using Command = std::variant<TextCommand, ListCommand, CompareOptions, ExportOptions, MeshOptions,
                             InfoOptions, ConvertOptions, BuildOptions, QueryOptions>;

/// Throws InputError for what is no valid command line.
Command parse_command_line(int argc, const char* const* argv);

}  // namespace controlspace
