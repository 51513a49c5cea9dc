#pragma once

#include <vector>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Structures whose metrics OpenVDB holds.
std::vector<CatalogueEntry> openvdb_rows();

}  // namespace controlspace
