#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// A surface as its vertices and which of them share a polygon's side: vertex i has the neighbours
/// `neighbours[first[i]] .. neighbours[first[i + 1] - 1]`.
struct SurfaceMesh {
    std::vector<Point> vertices;
    std::vector<std::size_t> first;
    std::vector<std::uint32_t> neighbours;
};

/// Reads a surface of polygons (.stl, .obj, .ply, .off); vertices at the same place are one. Throws
/// InputError that names the file for what cannot be read, for more vertices than the file has room
/// for, and for one without polygons.
SurfaceMesh read_surface_mesh(const std::filesystem::path& path);

}  // namespace controlspace
