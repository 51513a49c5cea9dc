// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace controlspace {

// Grids of other programs. Their trees take long to compile: in made_grids.cpp, once.

/// One value at voxels (0, 0, 0) to (3, 3, 3), half a unit apart.
openvdb::FloatGrid::Ptr lengths(const std::string& name, float value);
openvdb::FloatGrid::Ptr no_lengths(const std::string& name);
/// The same, one unit apart.
openvdb::Vec3SGrid::Ptr tensors(const std::string& name, const openvdb::Vec3s& value);

}  // namespace controlspace
