#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/given_settings.h"
#include "controlspace/io/write_vdb.h"
#include "controlspace/io/write_vtk.h"

namespace controlspace {

/// What the command line of `export` asks for.
struct ExportOptions {
    std::filesystem::path input;   ///< as of filled_space; empty: the paper's sphere
    std::filesystem::path output;  ///< its ending says the format
    GivenSettings settings;        ///< they override the study file in all of its runs
    std::string command_line;
    bool quiet = false;

    VdbOptions vdb;             ///< .vdb; without sources and notes
    bool with_sources = false;  ///< .vdb: as a grid of points too

    std::filesystem::path mesh;           ///< .sol, .solb: at the vertices of this mesh
    bool nodes = false;                   ///< .vtu: the control nodes in place of the leaves
    std::vector<std::string> slice{"z"};  ///< .vti: axis and place on it, the middle if left out
    int samples = Slice{}.samples;        ///< .vti: along the longer edge
};

/// Makes and grades the one structure that `options` ask for, K_oL if nothing is said, writes its
/// field to a file, and says on standard output what was written. Throws InputError.
void export_field(const ExportOptions& options);

/// The endings of files that the program can write fields to, for help texts: ".vdb, .sol, .solb".
std::string exported_formats();

}  // namespace controlspace
