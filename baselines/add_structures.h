// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Appends rows to `structures()`: every command then knows them. To be called before the first use
/// of that list, by one thread; throws std::logic_error afterwards.
void add_structures(std::span<const CatalogueEntry> rows);

}  // namespace controlspace
