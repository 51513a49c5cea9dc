#pragma once

#include <filesystem>
#include <string>

#include "app/given_settings.h"
#include "export/write_vdb.h"

namespace controlspace {

/// What the command line of `export` asks for.
struct ExportOptions {
    std::filesystem::path input;   ///< study file or file of sources; empty: the paper's sphere
    std::filesystem::path output;  ///< .vdb
    GivenSettings settings;        ///< they override the study file in all of its runs
    VdbOptions vdb;                ///< without sources and notes
    bool with_sources = false;     ///< as a grid of points too
    std::string command_line;
};

/// Makes and grades the one structure that `options` ask for, K_oL if nothing is said, writes its
/// field to a file, and says on standard output what was written. Throws InputError.
void export_vdb(const ExportOptions& options);

}  // namespace controlspace
