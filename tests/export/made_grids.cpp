// SPDX-License-Identifier: Apache-2.0
#include "export/made_grids.h"

namespace controlspace {

openvdb::FloatGrid::Ptr lengths(const std::string& name, float value) {
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(0);
    grid->fill({{0, 0, 0}, {3, 3, 3}}, value);
    grid->setName(name);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    return grid;
}

openvdb::FloatGrid::Ptr no_lengths(const std::string& name) {
    const auto grid = openvdb::FloatGrid::create(1);
    grid->setName(name);
    return grid;
}

openvdb::Vec3SGrid::Ptr tensors(const std::string& name, const openvdb::Vec3s& value) {
    const auto grid = openvdb::Vec3SGrid::create(openvdb::Vec3s(0));
    grid->fill({{0, 0, 0}, {3, 3, 3}}, value);
    grid->setName(name);
    return grid;
}

}  // namespace controlspace
