// SPDX-License-Identifier: Apache-2.0
#include "controlspace/version.h"
#include "modules/load.h"
#include "modules/tables.h"

CONTROLSPACE_MODULE {
    static const controlspace::VtkModule table{.version = controlspace::version(),
                                               .read_vtk_sources = controlspace::read_vtk_sources,
                                               .read_vtk_field = controlspace::read_vtk_field};
    return &table;
}
