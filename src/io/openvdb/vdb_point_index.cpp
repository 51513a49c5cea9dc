// SPDX-License-Identifier: Apache-2.0
#include <openvdb/points/PointConversion.h>

#include "io/openvdb/vdb_points.h"

namespace controlspace {

openvdb::tools::PointIndexGrid::Ptr point_index(const std::vector<openvdb::Vec3d>& positions,
                                                const openvdb::math::Transform& transform) {
    const openvdb::points::PointAttributeVector<openvdb::Vec3d> list(positions);
    return openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(list, transform);
}

}  // namespace controlspace
