// SPDX-License-Identifier: Apache-2.0
#include "controlspace/version.h"
#include "modules/load.h"
#include "modules/tables.h"

CONTROLSPACE_MODULE {
    static const controlspace::CgalModule table{
        .version = controlspace::version(),
        .read_surface_mesh = controlspace::read_surface_mesh,
        .surface_edges = controlspace::surface_edges,
        .surface_sources = controlspace::surface_sources,
        .wall_requests = controlspace::wall_requests,
        .surface_distance = controlspace::surface_distance};
    return &table;
}
