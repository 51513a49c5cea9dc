// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "controlspace/fields/formula_field.h"
#include "controlspace/geometry/box.h"
#include "sources/files.h"

namespace controlspace {

/// Six numbers that all differ and vary.
inline Metric wavy(const Point& x) {
    return {0.30 + 0.05 * std::sin(2 * x.x()),
            0.40 + 0.05 * std::cos(3 * x.y()),
            0.50 + 0.05 * std::sin(x.z()),
            0.02 + 0.01 * x.x(),
            -0.03 + 0.01 * x.y(),
            0.05 + 0.01 * x.z()};
}

/// Lengths that grow away from the sphere of radius 0.8.
inline Metric around_sphere(const Point& x) {
    return Metric::isotropic(0.03 + 0.25 * std::abs(x.norm() - 0.8));
}

inline const Box two_cube{Point::Constant(-1), Point::Constant(1)};

/// A grid of a file, as OpenVDB itself reads it.
template <class Grid>
typename Grid::Ptr read_grid(const std::filesystem::path& path, const std::string& name) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open(false);
    return openvdb::gridPtrCast<Grid>(file.readGrid(name));
}

/// A file of `grids`, as OpenVDB itself writes it.
inline std::filesystem::path write_grids(const ScratchDirectory& folder,
                                         const openvdb::GridCPtrVec& grids) {
    openvdb::initialize();
    const std::filesystem::path path = folder.path() / "foreign.vdb";
    openvdb::io::File(path.string()).write(grids);
    return path;
}

}  // namespace controlspace
