#include "baselines/peers/nanovdb/dense_grid.h"

#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/Grid.h>

#include "baselines/openvdb/dense_tree.h"

namespace controlspace {

nanovdb::GridHandle<nanovdb::HostBuffer> dense_nano_grid(
    const LatticeData& data, openvdb::Vec3s (*value_of)(const Metric&)) {
    using OpenGrid = openvdb::Vec3SGrid;
    const auto grid = OpenGrid::create(value_of(largest_metric(data.options())));
    fill_densely(grid->tree(), data, value_of);
    return nanovdb::openToNanoVDB<nanovdb::HostBuffer, OpenGrid::TreeType>(
        *grid, nanovdb::StatsMode::Disable, nanovdb::ChecksumMode::Disable);
}

double dense_vec3s_bytes(const Vector& nodes) { return dense_bytes<openvdb::Vec3STree>(nodes); }

}  // namespace controlspace
