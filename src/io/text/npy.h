#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

// Arrays of NumPy (.npy): two axes, doubles of this machine's byte order, by rows.

/// What stands before the numbers of an array.
std::string npy_header(std::size_t rows, std::size_t columns);

/// Sources as rows x, y, z, h or x, y, z, h, g, as in a table (csv.h). They are read row by row:
/// nothing but the sources is in memory. Throws InputError "name, row n: what is wrong".
std::vector<PointSource> read_npy_sources(const std::filesystem::path& path);

}  // namespace controlspace
