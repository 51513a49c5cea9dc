// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace controlspace {

// Modules: shared libraries, one for each external library, in the folder `controlspace` beside the
// C library. A module is loaded when a function of its library is first called; work that calls
// none needs none of these libraries, which together are more than a hundred.
//
// NAME_module.cpp is the module: linked from the static libraries of the project, with a copy of
// what it needs of the core, hidden. It exports one function, which returns its table of functions
// (tables.h). calls.cpp and openvdb_calls.cpp define these functions again, under their own names,
// as calls through the tables; the program and the C library are linked with those. Objects cross
// the boundary (control spaces, exceptions, strings), state does not.
//
// To add a function: a member of the table, its value in the module, and its call.

/// Loads the module `name` ("openvdb", "vtk", "netcdf", "cgal", "gmsh") unless it is loaded
/// already. Throws InputError where it is missing, of another version, or misses a library itself.
void load_module(const std::string& name);

/// Loads the module that structures of this name need, if any. Throws as load_module.
void load_module_of(std::string_view structure);

/// The table of the module `name`. Throws as load_module.
const void* module_table_of(const std::string& name);

template <class Table>
const Table& module_table(const char* name) {
    static const auto& table = *static_cast<const Table*>(module_table_of(name));
    return table;
}

}  // namespace controlspace

/// Starts the definition of the function that a module exports.
#define CONTROLSPACE_MODULE \
    extern "C" __attribute__((visibility("default"))) const void* controlspace_module()
