#include "controlspace/baselines/catalogue.h"

#include <iterator>
#include <vector>

#include "baselines/direct.h"
#include "baselines/uniform_grid.h"
#ifdef CONTROLSPACE_OPENVDB
#include "baselines/openvdb_grid.h"
#include "baselines/openvdb_levels.h"
#include "baselines/openvdb_vec3s.h"
#endif

namespace controlspace {

namespace {

using Make = std::unique_ptr<ControlSpace> (*)(const SpaceOptions&, Interpolation);

template <Make make, Interpolation interpolation>
CatalogueEntry grid(std::string id, std::string description) {
    CatalogueEntry entry;
    entry.has_voxels = true;
    entry.id = std::move(id);
    entry.description = std::move(description);
    entry.order = interpolation == Interpolation::nearest ? 0 : 1;
    entry.construct = [](const SpaceOptions& options) { return make(options, interpolation); };
    return entry;
}

#ifdef CONTROLSPACE_OPENVDB
std::vector<CatalogueEntry> openvdb_structures() {
    std::vector<CatalogueEntry> entries{
        grid<make_openvdb_grid, Interpolation::nearest>(
            "openvdb-uniform-nearest", "OpenVDB 5-4-3 tree, dense, a metric per voxel, constant"),
        grid<make_openvdb_grid, Interpolation::trilinear>(
            "openvdb-uniform-trilinear",
            "OpenVDB 5-4-3 tree, dense, a metric per voxel, trilinear")};
    entries[0].former_id = "openvdb-nearest";
    entries[1].former_id = "openvdb-trilinear";
    entries.push_back(grid<make_openvdb_levels, Interpolation::nearest>(
        "openvdb-levels-nearest",
        "OpenVDB 3-3-2 trees, a stack of grids, a metric per voxel, constant"));
    entries.push_back(grid<make_openvdb_levels, Interpolation::trilinear>(
        "openvdb-levels-trilinear",
        "OpenVDB 3-3-2 trees, a stack of grids, a metric per voxel, trilinear"));
    entries[2].has_levels = entries[3].has_levels = true;
    for (CatalogueEntry& entry : entries) entry.can_prune = true;
    entries.push_back({.id = "openvdb-vec3s-trilinear",
                       .description = "two of OpenVDB's Vec3S trees, dense, in floats, trilinear",
                       .order = 1,
                       .construct = make_openvdb_vec3s,
                       .has_voxels = true,
                       .rounding = 1e-6});
    return entries;
}
#endif

std::vector<CatalogueEntry> all_structures() {
    const std::span<const CatalogueEntry> trees = tree_catalogue();
    std::vector<CatalogueEntry> all(trees.begin(), trees.end());
    const std::span<const CatalogueEntry> anchored = anchored_catalogue();
    all.insert(all.end(), anchored.begin(), anchored.end());
    all.push_back(grid<make_uniform_grid, Interpolation::nearest>(
        "uniform-nearest", "uniform grid, a metric per cell, constant"));
    all.push_back(grid<make_uniform_grid, Interpolation::trilinear>(
        "uniform-trilinear", "uniform grid, a metric per vertex, trilinear"));
#ifdef CONTROLSPACE_OPENVDB
    for (CatalogueEntry& entry : openvdb_structures()) all.push_back(std::move(entry));
#endif
    all.push_back({.id = "direct",
                   .description = "no structure: the sources, searched; exact everywhere",
                   .exact_at_nodes = false,
                   .construct = make_direct,
                   .graded_from_start = true});
    return all;
}

}  // namespace

std::span<const CatalogueEntry> structures() {
    static const std::vector<CatalogueEntry> all = all_structures();
    return all;
}

}  // namespace controlspace
