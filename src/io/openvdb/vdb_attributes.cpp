// SPDX-License-Identifier: Apache-2.0
// Apart from vdb_points.cpp, as both take long to compile.
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>

#include "io/openvdb/vdb_points.h"

namespace controlspace {

namespace points = openvdb::points;

template <class Value>
void add_attribute(points::PointDataGrid& grid, const openvdb::tools::PointIndexGrid& index,
                   const std::string& name, const std::vector<Value>& values) {
    points::appendAttribute<Value>(grid.tree(), name);
    points::populateAttribute(grid.tree(), index.tree(), name,
                              points::PointAttributeVector<Value>(values));
}

template void add_attribute(points::PointDataGrid&, const openvdb::tools::PointIndexGrid&,
                            const std::string&, const std::vector<float>&);
template void add_attribute(points::PointDataGrid&, const openvdb::tools::PointIndexGrid&,
                            const std::string&, const std::vector<openvdb::Vec3s>&);

}  // namespace controlspace
