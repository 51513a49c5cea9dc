// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/catalogue.h"

#include "baselines/lattice/grid_row.h"

namespace controlspace {

std::vector<CatalogueEntry> openvdb_rows() {
    std::vector<CatalogueEntry> rows{
        grid_row<make_openvdb_grid, Interpolation::nearest>(
            "openvdb-uniform-nearest", "OpenVDB 5-4-3 tree, dense, a value per voxel, constant"),
        grid_row<make_openvdb_grid, Interpolation::trilinear>(
            "openvdb-uniform-trilinear",
            "OpenVDB 5-4-3 tree, dense, a value per voxel, trilinear")};
    rows[0].former_id = "openvdb-nearest";
    rows[1].former_id = "openvdb-trilinear";
    for (CatalogueEntry& row : rows) row.capabilities.push_back(Pruning());
    rows.push_back({.id = "openvdb-tiles",
                    .description = "OpenVDB tree, sparse: K_oL's leaves as tiles and voxels",
                    .construct = make_openvdb_tiles,
                    .capabilities = {SourceLeaves(), MetricNodes(), CompactForm(),
                                     VdbFiles{state_in_octree_file}}});
    rows.push_back({.id = "openvdb-bricks",
                    .description = "OpenVDB tree, sparse, of bricks of 4^3 cells, trilinear",
                    .order = 1,
                    .construct = make_openvdb_bricks,
                    .capabilities = {SourceLeaves(), MetricNodes(), CompactForm(), FittedValues(),
                                     VdbFiles{state_in_octree_file}}});
    rows.push_back({.id = "openvdb-vec3s-trilinear",
                    .description = "two of OpenVDB's Vec3S trees, dense, in floats, trilinear",
                    .order = 1,
                    .construct = make_openvdb_vec3s,
                    .capabilities = {MetricNodes{.rounding = 1e-6}, VoxelSize(), FittedValues()},
                    .own_precision = "metrics in floats, of lengths too"});
    return rows;
}

}  // namespace controlspace
