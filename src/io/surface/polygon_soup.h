// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "controlspace/geometry/point.h"

namespace controlspace {

/// Polygons as a file has them, by the numbers of their points (from 0).
struct PolygonSoup {
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> polygons;
    bool in_floats = false;  ///< a binary .stl, whose coordinates have 24 bits
};

/// Reads a .stl, all solids of a text one together; the faces of a .obj, whatever else is in it; a
/// .ply or a .off. A byte order mark is passed over. Throws InputError that names the file, and the
/// line or byte where it is known, for what cannot be read or is cut off, and for polygons with
/// corners that are no points.
PolygonSoup read_polygon_soup(const std::filesystem::path& path);

}  // namespace controlspace
