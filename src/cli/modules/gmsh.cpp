#include "cli/modules/module.h"
#include "controlspace/version.h"

CONTROLSPACE_MODULE(GmshModule) {
    static const controlspace::GmshModule table{.version = controlspace::version(),
                                                .mesh_with_gmsh = controlspace::mesh_with_gmsh};
    return &table;
}
