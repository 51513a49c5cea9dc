// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "controlspace/sources/point_source.h"

namespace controlspace {

/// The `part`-th of `parts` of the sources in a .csv, by its bytes: all parts one after the other
/// are what read_sources gives. No more than the part is read. Throws InputError as read_sources
/// does for the whole file; for a file whose size is not known, too.
std::vector<PointSource> read_csv_part(const std::filesystem::path& path, int part, int parts);

}  // namespace controlspace
