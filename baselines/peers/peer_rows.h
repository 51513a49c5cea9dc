// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// The rows of all foreign systems that this build has the libraries of, in the order of their
/// folders' names; their family is "peers".
std::vector<CatalogueEntry> peer_rows();

}  // namespace controlspace
