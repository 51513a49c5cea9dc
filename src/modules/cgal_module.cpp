#include "controlspace/version.h"
#include "modules/load.h"
#include "modules/tables.h"

CONTROLSPACE_MODULE {
    static const controlspace::CgalModule table{
        .version = controlspace::version(),
        .read_surface_mesh = controlspace::read_surface_mesh,
        .read_surface_sources = controlspace::read_surface_sources};
    return &table;
}
