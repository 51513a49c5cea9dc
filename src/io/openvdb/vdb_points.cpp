// SPDX-License-Identifier: Apache-2.0
#include "io/openvdb/vdb_points.h"

#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>

#include "controlspace/io/metric_grids.h"
#include "io/openvdb/vdb_builder.h"

namespace controlspace {

namespace points = openvdb::points;

openvdb::GridBase::Ptr make_points_grid(std::span<const PointSource> sources,
                                        const openvdb::math::Transform& transform) {
    std::vector<openvdb::Vec3d> positions;
    std::vector<float> smallest;
    std::vector<openvdb::Vec3s> diagonals;
    std::vector<openvdb::Vec3s> off_diagonals;
    for (const auto& [p, m, growth] : sources) {
        positions.emplace_back(p.x(), p.y(), p.z());
        smallest.push_back(static_cast<float>(eigen_frame(m).lengths[0]));
        diagonals.emplace_back(m.xx, m.yy, m.zz);
        off_diagonals.emplace_back(m.xy, m.xz, m.yz);
    }
    const points::PointAttributeVector<openvdb::Vec3d> list(positions);
    const auto index = point_index(positions, transform);
    const auto grid = points::createPointDataGrid<points::NullCodec, points::PointDataGrid>(
        *index, list, transform);
    add_attribute(*grid, *index, "pscale", smallest);
    add_attribute(*grid, *index, std::string(diagonal_grid), diagonals);
    add_attribute(*grid, *index, std::string(off_diagonal_grid), off_diagonals);
    grid->setName(std::string(sources_grid));
    return grid;
}

}  // namespace controlspace
