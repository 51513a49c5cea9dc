#pragma once

#include <vector>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Uniform Cartesian grids over the domain, their metrics in one flat array, x fastest: what a user
/// writes who wants no tree.
std::vector<CatalogueEntry> uniform_rows();

}  // namespace controlspace
