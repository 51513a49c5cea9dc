// SPDX-License-Identifier: Apache-2.0
#include "controlspace/version.h"

namespace controlspace {

std::string_view version() { return CONTROLSPACE_VERSION; }

}  // namespace controlspace
