// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/geometry/point.h"
#include "controlspace/mesh/tet_mesh.h"

namespace controlspace {

/// What is filled with tetrahedra: the bodies inside of a closed surface of triangles, which may be
/// hollow, or the solids of a CAD file, which share faces where they touch.
struct Part {
    std::vector<Point> vertices = {};
    std::vector<Triangle> triangles = {};
    /// Angle between the normals of triangles from which on the mesh keeps the edge [degrees].
    double crease = 30;
    /// In place of triangles: a .step, .stp, .iges, .igs or .brep.
    std::filesystem::path cad = {};
    Box box = {};      ///< around it
    double scale = 1;  ///< of millimetres, in which Gmsh reads CAD files, in units of the field
};

}  // namespace controlspace
