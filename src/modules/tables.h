// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "baselines/openvdb/catalogue.h"
#include "controlspace/gmsh/gmsh_mesher.h"
#include "controlspace/io/read_vdb.h"
#include "controlspace/io/read_vtk_sources.h"
#include "controlspace/io/write_vdb.h"
#include "gmsh/cad_surface.h"
#include "io/netcdf/write_netcdf.h"
#include "io/surface/surface_distance.h"
#include "io/surface/surface_mesh.h"
#include "io/surface/surface_sources.h"

namespace controlspace {

// What the modules export (see load.h).

/// The module of OpenVDB: its structures, and .vdb files.
struct OpenvdbModule {
    std::string_view version;
    decltype(&controlspace::make_openvdb_grid) make_openvdb_grid;
    decltype(&controlspace::make_openvdb_bricks) make_openvdb_bricks;
    decltype(&controlspace::make_openvdb_tiles) make_openvdb_tiles;
    decltype(&controlspace::make_openvdb_vec3s) make_openvdb_vec3s;
    decltype(&controlspace::state_in_octree_file) state_in_octree_file;
    decltype(&controlspace::read_vdb_sources) read_vdb_sources;
    decltype(&controlspace::read_vdb_field) read_vdb_field;
    VdbReport (*write_vdb)(const std::filesystem::path&, const ControlSpace&, const VdbOptions&);
};

/// The module of VTK: files for ParaView.
struct VtkModule {
    std::string_view version;
    decltype(&controlspace::read_vtk_sources) read_vtk_sources;
    decltype(&controlspace::read_vtk_field) read_vtk_field;
};

/// The module of netCDF: rasters.
struct NetcdfModule {
    std::string_view version;
    decltype(&controlspace::write_netcdf) write_netcdf;
};

/// The module of CGAL: sources from surfaces.
struct CgalModule {
    std::string_view version;
    decltype(&controlspace::read_surface_mesh) read_surface_mesh;
    decltype(&controlspace::surface_edges) surface_edges;
    decltype(&controlspace::surface_sources) surface_sources;
    decltype(&controlspace::wall_requests) wall_requests;
    decltype(&controlspace::surface_distance) surface_distance;
};

/// The module of Gmsh, which is under the GPL: meshes and CAD files.
struct GmshModule {
    std::string_view version;
    decltype(&controlspace::mesh_with_gmsh) mesh_with_gmsh;
    decltype(&controlspace::read_cad_surface) read_cad_surface;
    decltype(&controlspace::cad_box) cad_box;
};

}  // namespace controlspace
