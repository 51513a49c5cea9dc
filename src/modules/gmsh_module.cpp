// SPDX-License-Identifier: Apache-2.0
#include "controlspace/version.h"
#include "modules/load.h"
#include "modules/tables.h"

CONTROLSPACE_MODULE {
    static const controlspace::GmshModule table{.version = controlspace::version(),
                                                .mesh_with_gmsh = controlspace::mesh_with_gmsh,
                                                .read_cad_surface = controlspace::read_cad_surface,
                                                .cad_box = controlspace::cad_box};
    return &table;
}
