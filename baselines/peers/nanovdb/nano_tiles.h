// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Sparse NanoVDB grids of lengths, with the cells of K_oL.
std::vector<CatalogueEntry> nanovdb_tiles_rows();

}  // namespace controlspace
