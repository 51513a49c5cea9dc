#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "baselines/openvdb/openvdb_grid.h"
#include "baselines/openvdb/openvdb_levels.h"
#include "baselines/openvdb/openvdb_vec3s.h"
#include "controlspace/gmsh/gmsh_mesher.h"
#include "controlspace/io/read_surface_sources.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/read_vtk_sources.h"
#include "controlspace/io/write_vdb.h"
#include "io/surface/surface_mesh.h"

namespace controlspace {

// Modules: shared libraries beside the program, one for each external library, which it loads when
// a function of that library is first called. Without them the program needs none of these
// libraries, which together are more than a hundred.
//
// A module is linked from the static libraries of the project and has a copy of what it needs of
// the core, hidden; objects (control spaces, exceptions, strings) cross the boundary, no state
// does. It exports one function, `controlspace_module`, which returns one of the tables below.
// calls.cpp defines the functions of the tables again, under their own names, as calls through the
// table; the program is linked with those. To add a function: a line in the table, and its call. To
// add a module: a table, its file NAME.cpp, its calls and a line of CMakeLists.txt.

struct OpenvdbModule {
    std::string_view version;
    decltype(&controlspace::make_openvdb_grid) make_openvdb_grid;
    decltype(&controlspace::make_openvdb_levels) make_openvdb_levels;
    decltype(&controlspace::make_openvdb_vec3s) make_openvdb_vec3s;
    decltype(&controlspace::read_vdb_sources) read_vdb_sources;
    decltype(&controlspace::read_vdb_field) read_vdb_field;
    VdbReport (*write_vdb)(const std::filesystem::path&, const ControlSpace&, const VdbOptions&);
};

struct VtkModule {
    std::string_view version;
    decltype(&controlspace::read_vtk_sources) read_vtk_sources;
};

struct CgalModule {
    std::string_view version;
    decltype(&controlspace::read_surface_mesh) read_surface_mesh;
    decltype(&controlspace::read_surface_sources) read_surface_sources;
};

struct GmshModule {
    std::string_view version;
    decltype(&controlspace::mesh_with_gmsh) mesh_with_gmsh;
};

/// Loads the module `name` ("openvdb", "vtk", "cgal", "gmsh") unless it is loaded already. Throws
/// InputError where it is missing, does not fit the program, or misses a library itself.
void load_module(const std::string& name);

/// Loads the module that structures of this name need, if any. Throws as load_module.
void load_module_of(std::string_view structure);

}  // namespace controlspace

#define CONTROLSPACE_MODULE(Table)                                               \
    extern "C" __attribute__((visibility("default"))) const controlspace::Table* \
    controlspace_module()
