#include "cli/modules/module.h"
#include "controlspace/version.h"

CONTROLSPACE_MODULE(VtkModule) {
    static const controlspace::VtkModule table{
        .version = controlspace::version(),
        .read_vtk_sources = controlspace::read_vtk_sources,
        .write_leaves = controlspace::write_leaves,
        .write_nodes = controlspace::write_nodes,
        .write_octree = controlspace::write_octree,
        .write_slice = controlspace::write_slice,
        .write_vtk_sources = controlspace::write_vtk_sources};
    return &table;
}
