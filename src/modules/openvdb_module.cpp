// SPDX-License-Identifier: Apache-2.0
#include "controlspace/version.h"
#include "modules/load.h"
#include "modules/tables.h"

CONTROLSPACE_MODULE {
    static const controlspace::OpenvdbModule table{
        .version = controlspace::version(),
        .make_openvdb_grid = controlspace::make_openvdb_grid,
        .make_openvdb_bricks = controlspace::make_openvdb_bricks,
        .make_openvdb_tiles = controlspace::make_openvdb_tiles,
        .make_openvdb_vec3s = controlspace::make_openvdb_vec3s,
        .state_in_octree_file = controlspace::state_in_octree_file,
        .read_vdb_sources = controlspace::read_vdb_sources,
        .read_vdb_field = controlspace::read_vdb_field,
        .write_vdb = controlspace::write_vdb};
    return &table;
}
