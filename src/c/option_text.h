// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "controlspace/space/space_options.h"

namespace controlspace {

/// Options as a text names them, "tau=0.5 split=s_G", the others at their defaults
/// (c/controlspace.h lists them). Throws InputError for a name that is not known and a value that
/// does not fit.
SpaceOptions options_from_text(const Box& domain, std::string_view text);

}  // namespace controlspace
