// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Every structure of the study: the six trees of the paper, then what a user would pick instead.
/// OpenVDB's are there where the build has them (CONTROLSPACE_OPENVDB).
std::span<const CatalogueEntry> structures();

}  // namespace controlspace
