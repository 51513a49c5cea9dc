#include "cli/modules/module.h"
#include "controlspace/version.h"

CONTROLSPACE_MODULE(CgalModule) {
    static const controlspace::CgalModule table{
        .version = controlspace::version(),
        .read_surface_mesh = controlspace::read_surface_mesh,
        .read_surface_sources = controlspace::read_surface_sources};
    return &table;
}
