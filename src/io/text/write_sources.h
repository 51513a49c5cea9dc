#pragma once

#include <filesystem>
#include <span>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Writes `sources` in the format that the name's ending says: .csv (sources/csv.h), or .mesh,
/// .sol, .meshb or .solb, which makes a mesh and a solution (sources/write_medit_sources.h), or
/// .pos (sources/pos.h). They are read back by read_sources. Throws InputError for another ending,
/// and if writing fails, of which nothing is left.
void write_sources(const std::filesystem::path& path, std::span<const PointSource> sources);

}  // namespace controlspace
