#include "cli/modules/module.h"
#include "controlspace/version.h"

CONTROLSPACE_MODULE(VtkModule) {
    static const controlspace::VtkModule table{.version = controlspace::version(),
                                               .read_vtk_sources = controlspace::read_vtk_sources};
    return &table;
}
