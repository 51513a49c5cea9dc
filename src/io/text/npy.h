// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

// Arrays of NumPy (.npy): doubles of this machine's byte order, by rows.

/// The header of an array; `shape` is written as in Python: "3, 4".
std::string npy_header(std::string_view shape);

/// Sources from an array of two axes, as rows x, y, z, h or x, y, z, h, g, as in a table (csv.h).
/// They are read row by row: nothing but the sources is in memory. Throws InputError "name, row n:
/// what is wrong".
std::vector<PointSource> read_npy_sources(const std::filesystem::path& path);

}  // namespace controlspace
