#pragma once

#include <string>
#include <variant>

#include "app/build.h"
#include "app/compare.h"
#include "app/convert.h"
#include "app/export.h"
#include "app/info.h"
#include "app/mesh.h"
#include "app/paper.h"
#include "app/query.h"
#include "app/report.h"

namespace controlspace {

/// --help or --version: to be printed as it is.
struct TextCommand {
    std::string text;
};
struct ListCommand {};

using Command =
    std::variant<TextCommand, ListCommand, CompareOptions, ExportOptions, MeshOptions, PaperOptions,
                 ReportOptions, InfoOptions, ConvertOptions, BuildOptions, QueryOptions>;

/// Throws InputError for what is no valid command line.
Command parse_command_line(int argc, const char* const* argv);

}  // namespace controlspace
