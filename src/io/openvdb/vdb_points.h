// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/points/PointDataGrid.h>
#include <openvdb/tools/PointIndexGrid.h>

#include <string>
#include <vector>

namespace controlspace {

/// Numbers points by voxel.
openvdb::tools::PointIndexGrid::Ptr point_index(const std::vector<openvdb::Vec3d>& positions,
                                                const openvdb::math::Transform& transform);

/// Adds the attribute `name` to the points of `grid`, which `index` numbers. For float and Vec3s.
template <class Value>
void add_attribute(openvdb::points::PointDataGrid& grid,
                   const openvdb::tools::PointIndexGrid& index, const std::string& name,
                   const std::vector<Value>& values);

}  // namespace controlspace
