// SPDX-License-Identifier: Apache-2.0
#include "controlspace/version.h"
#include "modules/load.h"
#include "modules/tables.h"

CONTROLSPACE_MODULE {
    static const controlspace::NetcdfModule table{.version = controlspace::version(),
                                                  .write_netcdf = controlspace::write_netcdf};
    return &table;
}
