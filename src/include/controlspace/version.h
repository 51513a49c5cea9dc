// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace controlspace {

/// The library's version, "MAJOR.MINOR.PATCH" (semver.org); until 1.0, minor versions may change
/// what is there.
std::string_view version();

}  // namespace controlspace
