#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sources/point_source.h"

namespace controlspace {

/// Sources from a file, by its extension: `.csv` (sources/csv.h), or `.mesh`, `.meshb`, `.sol` or
/// `.solb`, a mesh or a solution that has the other beside it under the same name
/// (sources/medit.h), or `.pos` of one view (sources/pos.h). A pipe without an extension is read as
/// CSV. Throws InputError for anything that cannot be read as such.
std::vector<PointSource> read_sources(const std::filesystem::path& path);

/// The ending of a file's name, which tells its format, in small letters: ".csv".
std::string lower_case_extension(const std::filesystem::path& path);

}  // namespace controlspace
